"""Figures on Brownian motion: a large particle in a gas."""

from gaspart.keys import count

TITLE = "A large particle in a gas"
CHAPTER = "Motion and its memory"
FIGURES = {
    "brownian_paths": {"paths": count("number of paths that are drawn of each point")},
    "brownian_msd": {},
}
