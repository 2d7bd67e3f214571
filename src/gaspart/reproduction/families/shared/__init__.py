"""Moved to `reproduction.figure`."""

from gaspart.reproduction.figure import ENSKOG_LIMIT as ENSKOG_LIMIT
from gaspart.reproduction.figure import PARTICLES as PARTICLES
from gaspart.reproduction.figure import SOURCE_C as SOURCE_C

MODE_COUPLING = "hydrodynamic modes of the container, transport coefficients Enskog's (gaspart.theory.modes)"
