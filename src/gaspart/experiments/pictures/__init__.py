"""Pictures."""

TITLE = "Pictures"
FIGURES = ("gas_render", "brownian_render")
