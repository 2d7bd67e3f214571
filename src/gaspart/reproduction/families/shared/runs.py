"""Moved to `reproduction.figure`."""

from gaspart.reproduction.figure import *  # noqa: F403
