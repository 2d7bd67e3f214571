"""An observable of a run as its result states it: units, label, and what theory expects."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from gaspart.analysis import observables
from gaspart.analysis.flow import FLOW
from gaspart.analysis.run import Run


def described(name: str, run: Run, *places: Any, **given: Any) -> dict[str, Any]:
    """Units and label of an observable and, where there is a theory for a run, its values with their
    uncertainties, and the source. places, given: what its function of theory takes beside the run."""
    about: dict[str, Any] = dict(observables.about(name, run.dimension))
    stated = observables.OBSERVABLES[name].theory
    if not stated or run.about != FLOW:  # theory is about the flow
        return about
    module, function = stated.split(".")
    expect = getattr(import_module(f"gaspart.analysis.expected.{module}"), function)
    if (found := expect(run, *places, **given)) is None:
        return about
    value, error, source = found
    return {**about, "theory": (value, error), "source": source}
