"""The scatter of all claims."""

TITLE = "All claims together"
FIGURES: dict[str, dict] = {"claims_scatter": {}}
