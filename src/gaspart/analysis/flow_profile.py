"""The mean velocity of a gas along an axis."""

from __future__ import annotations

from gaspart.analysis.expected.described import described
from gaspart.analysis.fields import field
from gaspart.analysis.observable import Observable, observable
from gaspart.analysis.observables import require_defined
from gaspart.analysis.profiles import Means, with_freedom
from gaspart.analysis.run import Source, open_run


def velocity_profile(
    source: Source,
    axis: str | None = None,
    species: int | None = None,
    bins: int = 40,
    start: float | None = None,
) -> Observable:
    """Mean velocity of the moving particles along an axis, (component, position), in units length / time.

    That of the particles, not of their mass; NaN in bins that stay empty. Of sheared gases and between
    sliding walls it is that of the scene's frame of reference. source: a trajectory, by its path or open, or
    a simulation; axis: "x", "y" or "z", by default the last one; species: of one alone, by its number in the
    scene; bins: their number; start: the time from which frames count (by default a quarter of the run).
    Uncertainties are as of `field`.

    Theory: the flow of sheared images; between sliding plates free flight above a Knudsen number of 100, and
    a linear flow with slip below 0.1, and likewise the parabola of dilute spheres that a force drives along
    plates; otherwise, in equilibrium, that of the centre of mass everywhere.
    Raises SceneError for an unknown axis, a species that does not move, a file without all particles, and too
    few frames.
    """
    with open_run(source, start, sheared=True, varying=True) as run:
        require_defined("velocity", run.scene, axis=axis, species=species)
        name = "xyz"[run.dimension - 1] if axis is None else axis
        found = field(run.data, "velocity", name, bins, float(run.time[0]), species)
        places = found[name].values
        along = {
            "component": (found["component"].values, {"long_name": "component"}),
            "position": (places, {"units": "length", "long_name": name}),
        }
        about = described("velocity", run, "xyz".index(name), places)
        means = Means(found.estimate.values, found.error.values, found["velocity_freedom"].values)
        return with_freedom(observable("velocity", along, means.values, means.errors, **about), means)
