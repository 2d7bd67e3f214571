"""Moved to `reproduction.figure`."""

from gaspart.reproduction.figure import median as median
