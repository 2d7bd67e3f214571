"""Every observable that the battery measures, how it changes, and how two of its results are compared."""

from dataclasses import dataclass

import numpy as np
from battery.isometries import AXES
from scipy import stats

import gaspart as gp
from gaspart.analysis.fields import QUANTITIES
from gaspart.analysis.measuring import measure
from gaspart.analysis.observables import OBSERVABLES, observables_with, selecting
from gaspart.errors import SceneError

ROUNDED = 5e-6
"""Relative difference of two measurements that is one of the rounding of frames."""
CELLS = 4
"""Of a field, along each of its two axes."""
COSTLY = {name: {"bins": 12} for name in ("structure_factor", "partial_structure_factors")}
COSTLY["chemical_potential"], ENOUGH = {"trials": 16}, 18
"""Observables of which so many frames are looked at, from the first one on, and less in each."""
ACCUMULATED = ("msd", "vacf")
"""What a run with correlations of the motion has accumulated."""


AT_LAGS = ("D",)
"""Observables of which the lag is a form of their own, here that of `LAG` frames."""
LAG = 4
BY_IMPULSES = " by impulses"
BY_PAIRS = ("rdf",)
"""Observables that impulses of pairs make more accurate."""


@dataclass(frozen=True)
class Traits:
    """Those of a function without a name that declares them, as in `gaspart.analysis.declaration.Named`."""

    moving: bool = True
    scatter: str = "run"
    merged: str = ""
    along: tuple[str, ...] = ()


WITHOUT_NAME = {
    "by_species": Traits(scatter="particles", merged="split"),
    "field density": Traits(),
    "field velocity": Traits(moving=False),
    "field temperature": Traits(),
}
"""The functions that are measured without a name, and how they change."""
_PLACES = "places of insertion are drawn"
_WAVES = "some of many wave vectors are chosen"
SAMPLED = {
    ("chemical_potential", "shifted"): _PLACES,
    ("chemical_potential", "mirrored"): _PLACES,
    ("chemical_potential", "exchanged"): _PLACES,
    ("chemical_potential", "renumbered"): _PLACES,
    ("chemical_potential", "moving"): _PLACES,
    ("chemical_potential", "simulation"): _PLACES,
    ("structure_factor", "mirrored"): _WAVES,
    ("structure_factor", "exchanged"): _WAVES,
    ("partial_structure_factors", "mirrored"): _WAVES,
    ("partial_structure_factors", "exchanged"): _WAVES,
}
"""Those that hold within errors only, and why."""
SINGLE = {"order": 1e-4}
"""The limit of rounding of what freud computes in single precision."""
OF_FILES = {"rdf": 1e-2}
"""The limit where a file has in single precision what a simulation has in double: a pair may lie in the next
bin."""
MEANS = ("Z", "pressure", "collision_rate", "pair_rates", "pressure_tensor")
"""Means over the intervals between frames: that of a whole run follows from its parts."""


def traits_of(name):
    """How an observable changes: as it declares."""
    return WITHOUT_NAME.get(name) or OBSERVABLES[plain_name(name)]


def plain_name(name):
    """The name of an observable without that of a form of it."""
    return (
        name.removeprefix("accumulated ")
        .removesuffix(" per axis")
        .removesuffix(" at a lag")
        .removesuffix(BY_IMPULSES)
    )


def names():
    """All observables: those with a name, their forms of other files or axes, and functions without one."""
    found = list(OBSERVABLES)
    found += [f"{name} per axis" for name in selecting("per_axis")]
    found += [f"{name} at a lag" for name in AT_LAGS]
    found += [f"accumulated {name}" for name in ACCUMULATED]
    found += [f"{name}{BY_IMPULSES}" for name in (*observables_with(by_impulses=True), *BY_PAIRS)]
    return [*found, "by_species", *(f"field {of}" for of in QUANTITIES)]


def form_of(name):
    """The form of the file that an observable needs."""
    if name.startswith("accumulated"):
        return "correlations"
    if name.endswith(BY_IMPULSES):
        return "pair_impulses" if plain_name(name) in BY_PAIRS else "impulses"
    return "fluxes" if name in observables_with(needs="fluxes") else "frames"


def measured(name, data, axes, start=None):
    """The result. axes: the number of the axis of profiles, and those two of fields."""
    along, across = axes
    if name == "by_species":
        return gp.analysis.by_species(data, start)
    if name.startswith("field"):
        return gp.analysis.field(data, name.split()[1], "".join(AXES[k] for k in across), CELLS, start)
    plain = plain_name(name)
    selection = {"per_axis": True} if name.endswith("per axis") else {}
    if name.endswith("at a lag"):
        selection = {"lag": LAG * float(np.diff(data["time"].values[:2])[0])}
    if plain in selecting("axis"):
        selection = {"axis": AXES[along]}
    if plain not in COSTLY:
        return measure(data, plain, start, **selection)
    few = data if start is None else data.isel(frame=data["time"].values >= start - 1e-9)
    few = few.isel(frame=slice(None, None, max(1, (few.sizes["frame"] - 1) // ENOUGH)))
    first = float(few["time"].values[0])
    return getattr(gp.analysis, OBSERVABLES[plain].function)(few, start=first, **COSTLY[plain])


def outcome(name, data, axes, start=None):
    """The result, or the rule by which it is refused."""
    try:
        return measured(name, data, axes, start)
    except SceneError as error:
        return error


@dataclass(frozen=True)
class Deviation:
    """The largest difference of two results: relative to the largest value of each variable, and of the
    values in their standard uncertainties."""

    rounding: float
    errors: float


def deviation(expected, found, scatter=True):
    """How two results differ, of which the first has the dimensions of the second in any order. scatter:
    whether their uncertainties, too, must be equal. Raises AssertionError for other variables or places."""
    assert set(expected.data_vars) == set(found.data_vars)
    rounding, errors = 0.0, 0.0
    for name, new in found.data_vars.items():
        old = expected[name]
        for dim in new.dims:
            if dim in found.coords:
                old = _at_places(old, found[dim])
        old = old.transpose(*new.dims)
        uncertain = name.endswith(("_error", "_freedom")) or name == "stretches"
        if uncertain and not scatter:
            continue
        size = float(np.nanmax(np.abs(found[name.removesuffix("_error")].values), initial=0.0))
        if not name.endswith("_freedom"):
            rounding = max(rounding, _largest(old.values, new.values, size))
        if f"{name}_error" in found and not name.endswith("_theory"):
            other = np.asarray(found[f"{name}_error"].values, float)
            errors = max(errors, _in_errors(old.values, new.values, other, other))
    return Deviation(rounding, errors)


def apart(one, other):
    """By how many standard uncertainties two independent measurements differ: the normal deviate that is as
    rare as Student's of the largest difference, with the degrees of freedom of their errors."""
    rarest = 1.0
    for key in one.data_vars:
        if f"{key}_error" not in one or key.endswith("_theory"):
            continue
        a, b = (np.asarray(it[key].values, float) for it in (one, other))
        scatter = np.hypot(*(np.asarray(it[f"{key}_error"].values, float) for it in (one, other)))
        freedom = np.minimum(*(np.broadcast_to(_freedom(it, key), a.shape) for it in (one, other)))
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(
                np.abs(a - b) > ROUNDED * np.nanmax(np.abs(a), initial=0.0), np.abs(a - b) / scatter, 0.0
            )
        known = np.isfinite(ratio) & (freedom > 0.0)
        assert (known | np.isnan(ratio) | np.isnan(scatter)).all(), f"{key} has no error"
        chances = 2.0 * stats.t.sf(ratio[known], freedom[known])
        rarest = min(rarest, float(chances.min(initial=1.0)))
    return float(stats.norm.isf(0.5 * rarest))


def _freedom(found, key):
    """The degrees of freedom of errors: stated, or those of 16 groups or parts."""
    if f"{key}_freedom" in found:
        return np.nan_to_num(found[f"{key}_freedom"].values)
    return found.attrs.get("freedom", 15.0)


def _at_places(values, places):
    """An array with its elements in the order of the names, or at the numbers, of a coordinate."""
    dim = places.dims[0]
    if places.dtype.kind in "US":
        return values.sel({dim: places.values})
    if dim == "species":
        return values.sel({dim: places.values})
    assert values.sizes[dim] == places.size, dim
    assert np.allclose(
        values[dim].values, places.values, rtol=0.0, atol=ROUNDED * np.abs(places.values).max()
    )
    return values


def _largest(old, new, size):
    """The largest difference over the size of the values; infinite where one only is NaN."""
    old, new = np.asarray(old, float), np.asarray(new, float)
    if not np.array_equal(np.isnan(old), np.isnan(new)):
        return np.inf
    apart = float(np.nanmax(np.abs(old - new), initial=0.0))
    return apart / size if size > 0.0 else (np.inf if apart > 0.0 else 0.0)


def _in_errors(old, new, one, other):
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.nanmax(np.abs(old - new) / np.hypot(one, other), initial=0.0))
