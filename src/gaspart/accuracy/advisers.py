"""Advisers by the type of the engine, and the engines among which a plan chooses."""

from __future__ import annotations

from gaspart.accuracy.of_dsmc import DsmcAdviser
from gaspart.accuracy.of_engine import Adviser
from gaspart.accuracy.of_step import StepAdviser
from gaspart.engines import DSMC, ENGINES, Engine, TimeStepped

ADVISERS: dict[type[Engine], type[Adviser]] = {Engine: Adviser, TimeStepped: StepAdviser, DSMC: DsmcAdviser}
"""Advisers of engines and of the classes that are derived from them."""


def adviser_of(engine: Engine) -> Adviser:
    """Return the adviser of an engine."""
    return _adviser_type(type(engine))(engine)


def timed_as(engine: Engine) -> str:
    """Return the name of an engine in the table of costs."""
    return adviser_of(engine).timed_as


def candidate_engines() -> list[Engine]:
    """Return the candidate engines of a plan, beginning with the reference engine."""
    return sorted(
        (variant for engine in ENGINES.values() for variant in _adviser_type(engine).variants(engine)),
        key=lambda variant: not variant.reference,
    )


def _adviser_type(engine: type[Engine]) -> type[Adviser]:
    """Return the adviser of the nearest class from which a class of engines is derived."""
    return next(ADVISERS[kind] for kind in engine.__mro__ if kind in ADVISERS)
