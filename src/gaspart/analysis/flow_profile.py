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
    """Measure the mean velocity of the moving particles along an axis.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory, by its path or open, or a simulation.
    axis : {"x", "y", "z"}, optional
        The axis. Default: the last one.
    species : int, optional
        Only this species, by its number in the scene.
    bins : int, default 40
        Number of bins.
    start : float, [time], optional
        Frames before this time are discarded. Default: a quarter of the run.

    Returns
    -------
    Observable
        Mean velocity (component, position) in [length/time]. NaN in bins that stay empty.

    Raises
    ------
    SceneError
        If the axis is unknown, the species does not move, the file lacks particles, or there are too few
        frames.

    Notes
    -----
    It is the mean velocity of the particles, not of their mass. Of sheared gases and between sliding walls it
    is in the scene's frame of reference. Uncertainties are as of `field`.

    Theory: the flow of sheared images; between sliding plates free flight above a Knudsen number of 100, and
    a linear flow with slip below 0.1, and in the same range the parabola of dilute spheres that a force
    drives along plates; otherwise, in equilibrium, the velocity of the centre of mass everywhere.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(40.0)
    >>> gp.analysis.velocity_profile(simulation, axis="x", bins=4).estimate.shape
    (2, 4)
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
