"""The symmetries of the battery, each applied to a stored run: what an observable gives before and after."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import xarray as xr
from battery.isometries import View, data_seen, result_seen
from battery.kinds_of_runs import FRAMES, KINDS, recorded, repeated_simulation
from battery.observed import (
    MEANS,
    OF_FILES,
    SAMPLED,
    apart,
    deviation,
    form_of,
    outcome,
    plain_name,
    traits_of,
)
from battery.observed import SINGLE as IN_SINGLE
from battery.scaling import data_in_units, result_in_units

import gaspart as gp
from gaspart.errors import SceneError
from gaspart.yaml_text import dump_yaml, parse_yaml

ROUNDING = 1e-9
"""Largest relative difference of results that must be equal."""
SURPRISING = 5.0
"""Standard uncertainties by which the two most different of a pair of results may differ."""
VELOCITY = 0.75
"""Of the moving frame: exact in binary numbers."""


IMPULSES = ("impulses", "pair_impulses")
"""Forms of files with impulses."""
NO_SUMS = "such a run has no such sums"
SINGLE = 2e-5
"""Likewise where velocities in single precision meet the energy in double precision: from a moving frame,
whose motion adds their momentum to it, and of a simulation; numbers may lie in the next bin."""


@dataclass(frozen=True)
class Cell:
    """What was found of an observable, a symmetry, an engine and a kind of scene. state: "tested", "refused"
    (before and after, by the rule `text`), "not defined" (for the reason `text`), or "broken", `text` stating
    how; unit: of the deviation, "rounding" or "errors"."""

    observable: str
    symmetry: str
    engine: str
    scene: str
    state: str
    text: str = ""
    deviation: float = 0.0
    unit: str = ""


def axes_of(kind):
    """The axis of profiles, and the two of fields, in a kind of scene."""
    along = kind.mirror
    moving = kind.moving if isinstance(kind.moving, int) else 0
    return along, tuple(k for k in range(3) if k != moving)


def views(kind):
    """Symmetry -> the view, or why a kind of scene has none."""
    scene = kind.scene
    free = [
        along and not (scene.shear_rate is not None and k == 1)
        for k, along in enumerate(scene.container.periodic)
    ]
    signs, velocity = [1.0, 1.0, 1.0], [0.0, 0.0, 0.0]
    signs[kind.mirror] = -1.0
    alike = all(one.alike for one in scene.species)
    found = {
        "shifted": View(shift=tuple(0.5 * one for one in free)) if any(free) else "no axis is periodic",
        "mirrored": View(signs=tuple(signs)),
        "exchanged": kind.exchange if isinstance(kind.exchange, str) else View(order=kind.exchange),
        "renumbered": View(renumbered=True) if alike else "the radius of a particle follows from its number",
        "moving": kind.moving,
    }
    if isinstance(kind.moving, int):
        velocity[kind.moving] = VELOCITY
        found["moving"] = View(velocity=tuple(velocity))
    return found


@cache
def plain(engine, name, observable):
    """The result of a run, or the error by which it is refused."""
    return outcome(observable, recorded(engine, name)[form_of(observable)], axes_of(KINDS[name]))


def of_views(engine, name, observables):
    """The cells of all symmetries that are views of one run."""
    kind, run = KINDS[name], recorded(engine, name)
    axes = axes_of(kind)
    for symmetry, view in views(kind).items():
        new_axes, seen = axes, {}
        if isinstance(view, View):
            new_axes = view.axis(axes[0]), tuple(view.axis(k) for k in axes[1])
            seen = {form: data_seen(data, view) for form, data in run.items()}
        for observable in observables:
            place, form = (observable, symmetry, engine, name), form_of(observable)
            if form not in run:
                yield Cell(*place, "not defined", NO_SUMS)
            elif not isinstance(view, View):
                yield Cell(*place, "not defined", view)
            else:
                after = outcome(observable, seen[form], new_axes)
                expected = plain(engine, name, observable)
                if not isinstance(expected, SceneError):
                    expected = expected_result(expected, observable, kind, view, axes)
                yield judged(place, expected, after, SINGLE if symmetry == "moving" else ROUNDING)


def expected_result(found, observable, kind, view, axes):
    """What an observable of a run is from a view."""
    cells = {"position": axes[0], **{"xyz"[k]: k for k in axes[1]}}
    expected = result_seen(found, kind.scene, view, cells)
    expected = expected.rename({dim: str(dim)[-1] for dim in expected.dims if str(dim).startswith("new ")})
    if observable == "pair_rates" and view.renumbered:
        expected = _of_first(expected, kind.scene)
    if not traits_of(observable).moving and any(view.velocity):
        added = [view.velocity["xyz".index(one)] for one in expected["component"].values]
        key = expected.attrs["quantity"]
        moved = [one for one in (key, f"{key}_theory") if one in expected]
        expected = expected.assign({one: expected[one] + _along("component", added) for one in moved})
    return expected


def _along(dim, values):
    return xr.DataArray(np.array(values), dims=dim)


def _of_first(found, scene):
    """Rates of a particle of the first species of each pair, where the other one has become the first."""
    counts = [kind.count for kind in scene.species][::-1]  # as they are numbered now
    ratios = []
    for name in found["pair"].values.tolist():
        first, second = map(int, name.split("-"))
        ratios.append(counts[second] / counts[first])
    scale = _along("pair", ratios)
    return found.assign(
        {name: (values * scale).assign_attrs(values.attrs) for name, values in found.data_vars.items()}
    )


def judged(place, expected, after, limit=ROUNDING):
    """The cell of two results that should be equal, or of two refusals."""
    observable, symmetry = place[:2]
    if isinstance(expected, SceneError) or isinstance(after, SceneError):
        if type(expected) is not type(after):
            return Cell(*place, "broken", f"{_shown(expected)} before, {_shown(after)} after")
        return Cell(*place, "refused", expected.rule)
    sampled = (observable, symmetry) in SAMPLED
    regrouped = symmetry in ("renumbered", "one species") and traits_of(observable).scatter == "particles"
    try:
        found = deviation(expected, after, scatter=not sampled and not regrouped)
    except (AssertionError, KeyError, ValueError) as error:
        return Cell(*place, "broken", f"{type(error).__name__} {error}")
    if sampled:
        good = found.errors <= SURPRISING
        return Cell(*place, "tested" if good else "broken", "", found.errors, "errors")
    name = plain_name(observable)
    limit = max(limit, IN_SINGLE.get(name, 0.0), OF_FILES.get(name, 0.0) if symmetry == "simulation" else 0.0)
    good = found.rounding <= limit
    return Cell(*place, "tested" if good else "broken", "", found.rounding, "rounding")


def _shown(result):
    return f"refused ({result.rule})" if isinstance(result, SceneError) else "a value"


def in_units(engine, name, observables):
    """The cells of other units of length, mass and time."""
    kind, run = KINDS[name], recorded(engine, name)
    axes = axes_of(kind)
    scaled = {form: data_in_units(data) for form, data in run.items()}
    for observable in observables:
        place, form = (observable, "units", engine, name), form_of(observable)
        if form not in run:
            yield Cell(*place, "not defined", NO_SUMS)
            continue
        expected, after = plain(engine, name, observable), outcome(observable, scaled[form], axes)
        expected = expected if isinstance(expected, SceneError) else result_in_units(expected)
        yield judged(place, expected, after)


def divided(data):
    """A trajectory of one species as one of two equal halves, or the other way round."""
    scene = gp.Scene.from_dict(parse_yaml(data.attrs["scene"]))
    first = scene.species[0]
    if len(scene.species) == 1:
        half = replace(first, count=first.count // 2)
        new = replace(scene, species=(half, half))
    else:
        new = replace(scene, species=(replace(first, count=scene.count),))
        if "momentum_flux_sum" in data:
            flown = data["momentum_flux_sum"].sum("species", keepdims=True, keep_attrs=True)
            data = data.drop_vars("momentum_flux_sum").assign(momentum_flux_sum=flown)
    return data.drop_vars(["pair_collisions", "pair"], errors="ignore").assign_attrs(
        scene=dump_yaml(new.to_dict())
    )


def of_division(engine, name, observables):
    """The cells of two equal species against one."""
    kind, run = KINDS[name], recorded(engine, name)
    species = kind.scene.species
    alike = all(one == species[0] and one.alike for one in species) and not kind.scene.is_open
    different = "of one species particles enter" if kind.scene.is_open else "its particles differ"
    other = {form: divided(data) for form, data in run.items()} if alike else {}
    for observable in observables:
        place, form = (observable, "one species", engine, name), form_of(observable)
        if form not in run:
            yield Cell(*place, "not defined", NO_SUMS)
        elif not alike:
            yield Cell(*place, "not defined", different)
        elif traits_of(observable).merged:
            yield Cell(*place, "not defined", "it is of each species or pair of species")
        elif form == "impulses" and len(species) == 1:
            yield Cell(*place, "not defined", "its file has no sums of the halves")
        else:
            after = outcome(observable, other[form], axes_of(kind))
            yield judged(place, plain(engine, name, observable), after)


def of_simulation(engine, name, observables):
    """The cells of a file against the simulation that it is of."""
    kind, run = KINDS[name], recorded(engine, name)
    again = {"frames": repeated_simulation(engine, name)}
    again |= {form: repeated_simulation(engine, name, form) for form in IMPULSES if form in run}
    for observable in observables:
        place, form = (observable, "simulation", engine, name), form_of(observable)
        if form not in again:
            rule = NO_SUMS if form in IMPULSES else "a simulation keeps no correlations"
            yield Cell(*place, "not defined", rule)
            continue
        after = outcome(observable, again[form], axes_of(kind))
        yield judged(place, plain(engine, name, observable), after, limit=SINGLE)


def of_parts(engine, name, observables):
    """The cells of a run against its parts, and of a late start against the end of the file."""
    kind, run = KINDS[name], recorded(engine, name)
    for observable in observables:
        if (form := form_of(observable)) not in run:
            yield Cell(observable, "parts", engine, name, "not defined", NO_SUMS)
            yield Cell(observable, "start", engine, name, "not defined", NO_SUMS)
            continue
        yield from _parts_of(observable, engine, name, kind, run[form])


def _parts_of(observable, engine, name, kind, data):
    axes, first, middle = axes_of(kind), FRAMES // 4, 5 * FRAMES // 8
    time = data["time"].values
    late = outcome(observable, data, axes, float(time[middle]))
    end = outcome(observable, data.isel(frame=slice(middle, None)), axes, float(time[middle]))
    yield judged((observable, "start", engine, name), late, end)
    place = observable, "parts", engine, name
    early = outcome(observable, data.isel(frame=slice(first, middle + 1)), axes, float(time[first]))
    whole = plain(engine, name, observable)
    if isinstance(whole, SceneError):
        yield judged(place, whole, early)
    elif isinstance(early, SceneError) or isinstance(late, SceneError):
        refusal = early if isinstance(early, SceneError) else late
        yield Cell(*place, "not defined", f"of a part: {refusal.rule}")
    elif observable in MEANS:
        mean = whole.assign({key: 0.5 * (early[key] + late[key]) for key in (whole.attrs["quantity"],)})
        yield judged(place, mean, whole, limit=SINGLE)
    elif kind.steady:
        yield Cell(*place, "not defined", kind.steady)
    else:
        yield _compared(place, early, late)


def _compared(place, one, other):
    """The cell of two independent measurements."""
    try:
        found = apart(one, other)
    except AssertionError as error:
        return Cell(*place, "broken", str(error))
    return Cell(*place, "tested" if found <= SURPRISING else "broken", "", found, "errors")
