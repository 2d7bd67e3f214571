"""A large body in a gas."""

TITLE = "A large body in a gas"
FIGURES = ("brownian_paths", "brownian_msd")
