"""Moved to `reproduction.figure`."""

from gaspart.reproduction.figure import ENSKOG_LIMIT as ENSKOG_LIMIT
from gaspart.reproduction.figure import PARTICLES as PARTICLES
from gaspart.reproduction.figure import SOURCE_C as SOURCE_C
