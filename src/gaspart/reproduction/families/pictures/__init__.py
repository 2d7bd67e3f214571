"""Figures that are rendered pictures of scenes."""

TITLE = "Pictures"
CHAPTER = "Pictures and checks"
FIGURES: dict[str, dict] = {"gas_render": {}, "brownian_render": {}}
