"""Pictures."""

TITLE = "Pictures"
CHAPTER = "Pictures and checks"
FIGURES: dict[str, dict] = {"gas_render": {}, "brownian_render": {}}
