"""Pictures."""

TITLE = "Pictures"
FIGURES: dict[str, dict] = {"gas_render": {}, "brownian_render": {}}
