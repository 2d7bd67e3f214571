"""The DSMC engine: collision partners are sampled among the particles of a cell, not searched."""

from gaspart.engines.dsmc.settings import DSMC

__all__ = ["DSMC"]
