"""Figures that a config states without code: an observable against a key of a grid."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gaspart.analysis.estimate import Estimate
from gaspart.analysis.observable import Observable, label_of
from gaspart.analysis.observables import OBSERVABLES, require_defined, require_kept
from gaspart.analysis.run import measure_single
from gaspart.analysis.statistics import average, fit_power_law
from gaspart.errors import SceneError
from gaspart.keys import NUMBER, TEXT, choice, describe, flag, list_of, names, positive, record
from gaspart.rendering import style
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Parts
from gaspart.reproduction.points.measurable import distinct, require_observable
from gaspart.reproduction.points.point import TRAJECTORIES, Point
from gaspart.reproduction.table import Row, Table, from_rows
from gaspart.trajectory.reading import open_trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TITLE = "Own figures"
CHAPTER = "Own figures"
CAPTION = describe(
    TEXT, "reStructuredText for the report, whose first words in bold are the finding", default=""
)

_CLAIM = record(
    {
        "that": choice(
            "what is stated, at every point or, `exponent`, of all points together: the value of theory, a "
            "bound, a value, or the exponent of a power law",
            *("theory", "at_least", "at_most", "value", "exponent"),
        ),
        "value": describe(NUMBER, "the bound, value or exponent", default=None),
        "tolerance": positive(
            "half of the width of the band in which a value or an exponent lies; with `theory`, if it is an "
            "approximation, the same over theory's value",
            default=None,
        ),
        "required": positive(
            "largest standard uncertainty of the measurement at which the claim is conclusive, with `theory` "
            "over theory's value; of a value and an exponent by default half of the tolerance",
            default=None,
        ),
        "between": list_of(
            NUMBER,
            "lowest and highest value of `against` of the points that it is about",
            2,
            2,
            default=None,
        ),
        "source": describe(
            {**TEXT, "minLength": 1}, "of the expected value; that of a theory is known", default=None
        ),
        "fails_if": describe({**TEXT, "minLength": 1}, "what would make it fail"),
    }
)
SETTINGS = {
    "observable": choice("what is measured, as by `gaspart measure`", *OBSERVABLES),
    "against": describe(
        {**TEXT, "minLength": 1},
        "the key of the grid, of numbers, that is the horizontal axis; of an observable that is a curve "
        "there is one curve for each of its values",
    ),
    "experiments": names("experiments that make trajectories, whose points are measured"),
    "place": describe(
        NUMBER, "of a curve: the place, or the nearest one, whose value is taken instead", default=None
    ),
    "theory": flag("draw theory, where there is one for the scene", default=True),
    "logarithmic": choice("axes with a logarithmic scale", "none", "x", "y", "both", default="none"),
    "caption": CAPTION,
    "claims": list_of(_CLAIM, "what is expected of the measurement", 0, default=[]),
}


def caption(settings: Mapping[str, Any]) -> str:
    """Return the caption of a figure from the config; add a title if it is missing."""
    text = str(settings.get("caption", "")).strip()
    if text.startswith("**") or "observable" not in settings:
        return text
    meaning = OBSERVABLES[settings["observable"]].definition.partition(",")[0]
    against = _words(settings["against"])
    return f"**{meaning[0].upper()}{meaning[1:]}, against {against}.** {text}".rstrip()


def _words(key: str) -> str:
    return key.removeprefix("scene.").replace("_", " ")


# Rules beyond the kinds of the settings, checked before any job.


NEEDED = {
    "theory": ("required",),
    "at_least": ("value", "required", "source"),
    "at_most": ("value", "required", "source"),
    "value": ("value", "tolerance", "source"),
    "exponent": ("value", "tolerance", "source"),
}
"""Required keys of a claim of each kind."""
_UNUSED = {"theory": ("value", "source"), "at_least": ("tolerance",), "at_most": ("tolerance",)}
_LEAST = 3
"""Minimum number of points for the fit of a power law."""


def validate(figure: str, settings: Mapping[str, Any], points: Sequence[Point]) -> None:
    """Raise SceneError for points or claims that do not fit a figure."""
    where, name, against = f"figures.{figure}", settings["observable"], settings["against"]
    for point in points:
        if point.job != TRAJECTORIES:
            rule = f"must make trajectories (job: {TRAJECTORIES})"
            raise SceneError(f"{where}.experiments", point.experiment, rule)
        value = point.settings.get(against)
        if not isinstance(value, int | float) or isinstance(value, bool):
            rule = f"must be a key whose value is a number at every point, but at {point.path} it is {value}"
            raise SceneError(f"{where}.against", against, rule)
        kept = [kept for key, kept in (("pairs", "pairs"), ("stress", "fluxes")) if point.settings.get(key)]
        try:
            require_defined(name, point.scene)
            require_kept(name, kept)
        except SceneError as error:
            rule = f"at {point.path}: {error.key}: {error.rule}"
            raise SceneError(f"{where}.observable", name, rule) from None
    curve, place = OBSERVABLES[name].form == "curve", settings.get("place")
    if place is not None and not curve:
        raise SceneError(f"{where}.place", place, "has a meaning for a curve only")
    for point in distinct(points):
        try:
            require_observable(name, point)
        except SceneError as error:
            rule = f"cannot be measured at {point.path}: {error.key}: {error.rule}"
            raise SceneError(f"{where}.observable", name, rule) from None
    at = sorted({float(point.settings[against]) for point in points})
    for number, claim in enumerate(settings.get("claims", ())):
        _check_claim(f"{where}.claims.{number}", claim, at, curve and place is None)


def _check_claim(where: str, claim: Mapping[str, Any], at: Sequence[float], curve: bool) -> None:
    """Raise SceneError for a claim whose keys do not fit, or without enough points; `at` are their values."""
    that, between = claim["that"], claim.get("between")
    if curve:
        raise SceneError(where, that, "of a curve needs the place whose value is meant: place")
    for key in NEEDED[that]:
        if claim.get(key) is None:
            raise SceneError(f"{where}.{key}", None, f"is required with that: {that}")
    for key in _UNUSED.get(that, ()):
        if claim.get(key) is not None:
            raise SceneError(f"{where}.{key}", claim[key], f"has no meaning with that: {that}")
    low, high = between or (at[0], at[-1])
    chosen = [value for value in at if low <= value <= high]
    if not chosen:
        rule = f"there is none of the points, which are from {at[0]:g} to {at[-1]:g}"
        raise SceneError(f"{where}.between", between, rule)
    if that == "exponent" and len(chosen) < _LEAST:
        raise SceneError(where, "exponent", f"needs {_LEAST} points or more; there are {len(chosen)}")


# Measurement of a point, which sweeps use too.


def measure_point(
    point: Point, names: Sequence[str], part: bool
) -> tuple[dict[str, list[Observable]], float, dict[str, SceneError]]:
    """Measure observables of all replicas of a point. Returns the observables by name, the mean duration of a
    replica, and error messages by name of observables that cannot be measured. Frames after the equilibration
    are used. With `part`, the first quarter of each run is left out instead.
    """
    start = None if part else point.schedule.equilibration
    results: dict[str, list[Observable]] = {name: [] for name in names}
    durations: list[float] = []
    refused: dict[str, SceneError] = {}
    for path in point.replica_paths:
        try:
            with open_trajectory(path) as trajectory:
                durations.append(float(trajectory["time"][-1]))
                for name in names:
                    try:
                        results[name].append(measure_single(trajectory, name, start))
                    except SceneError as error:
                        refused.setdefault(name, error.inside(f"{name} of {path}"))
        except SceneError as error:  # a damaged file
            refused |= {name: refused.get(name, error) for name in names}
    duration = float(np.mean(durations)) if durations else np.nan
    return {name: results[name] for name in names if name not in refused}, duration, refused


def mean_of(replicas: list[Observable], part: str) -> np.ndarray | None:
    """Average independent runs, or compute another property of the mean. The property `part` is the standard
    uncertainty (_error), theory (_theory), or the uncertainty of theory (_theory_error). Without a theory,
    None is returned. Runs that stop at a required accuracy may have curves of different lengths. Then only
    the common range is used.
    """
    quantity = replicas[0].attrs["quantity"]
    if part.startswith("_theory") and any(replica.theory is None for replica in replicas):
        return None
    values = [replica[quantity + part].values for replica in replicas]
    shape = np.min([value.shape for value in values], axis=0).astype(int)
    values = [value[tuple(slice(size) for size in shape)] for value in values]
    if part == "_error":
        return np.sqrt(np.sum(np.square(values), axis=0)) / len(values)
    return np.mean(values, axis=0)


_PARTS = {"value": "", "value_error": "_error", "theory": "_theory", "theory_error": "_theory_error"}


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure an observable of each point, averaged over its replicas, ordered by series and `against`. Each
    of several named values, such as one for each face, is a series. A curve has the dimension `along`. Raises
    SceneError for an observable that cannot be measured.
    """
    name, against = settings["observable"], settings["against"]
    rows, source = [], ""
    for point in points:
        results, _, refused = measure_point(point, [name], part=False)
        if refused:
            raise refused[name]
        replicas = results[name]
        if settings.get("place") is not None:
            (dim,) = replicas[0].estimate.dims
            replicas = [replica.sel({dim: settings["place"]}, method="nearest") for replica in replicas]
        source = source or replicas[0].attrs.get("source", "")
        for label, parts in _by_name(replicas).items():
            series = ", ".join(filter(None, (_other(point, points, against), label)))
            row = {"against": float(point.settings[against]), "series": series}
            rows.append({**row, **_numbers(parts)})
    rows.sort(key=lambda row: (row["series"], row["against"]))
    first = replicas[0].estimate
    dataset = from_rows("point", rows, inner=("along",))
    for key in _PARTS:
        dataset[key].attrs["units"] = first.attrs.get("units", "1")
    dataset["value"].attrs["long_name"] = first.attrs.get("long_name", OBSERVABLES[name].definition)
    if "along_places" in dataset:
        dataset["along_places"].attrs.update(replicas[0][first.dims[0]].attrs)
    return dataset.assign_attrs(against=against, observable=name, source=source)


def _by_name(replicas: list[Observable]) -> dict[str, list[Observable]]:
    """Split an observable with named values, such as faces; another observable is returned unchanged."""
    first = replicas[0].estimate
    if not first.dims or first[first.dims[0]].dtype.kind not in "UO":
        return {"": replicas}
    (dim,) = first.dims
    return {str(text): [replica.sel({dim: text}) for replica in replicas] for text in first[dim].values}


def _other(point: Point, points: list[Point], against: str) -> str:
    """Return what distinguishes a point from others at the same value of `against`. These are the other
    values of its grid, and the experiment if there are several.
    """
    several = len({other.experiment for other in points}) > 1
    varied = [part for part in point.name.split(",") if not part.startswith(f"{against}=")]
    return ", ".join([point.experiment] * several + [part for part in varied if part != "single"])


def _numbers(replicas: list[Observable]) -> dict[str, Any]:
    """Return the entries of a row for the mean of independent runs."""
    row: dict[str, Any] = {}
    for name, part in _PARTS.items():
        values = mean_of(replicas, part)
        row[name] = np.full_like(row["value"], np.nan) if values is None else values
    if row["value"].ndim:
        (dim,) = replicas[0].estimate.dims
        shortest = min((replica[dim].values for replica in replicas), key=len)
        return {**row, "along_places": shortest, "value_freedom": np.inf}
    estimates = [
        Estimate(replica.estimate, replica.error, replica.attrs.get("freedom", np.inf))
        for replica in replicas
    ]
    return {**row, "value_freedom": average(estimates).freedom}


APPROXIMATE = "the uncertainty of this theory is not known: a tolerance would decide"


def claims(dataset: xr.Dataset, stated: list[dict]) -> Iterator[Claim]:
    """Yield the claims of a config, `stated`, for each point or for each series."""
    for statement in stated:
        points = Table(dataset, "point")
        if statement.get("between") is not None:
            low, high = statement["between"]
            points = points[(points.against >= low) & (points.against <= high)]
        if statement["that"] == "exponent":
            for _, part in points.by("series"):
                yield _exponent(part, statement)
        else:
            for point in points:
                yield from _claims_at(point, statement)


def _text(subject: str, point: Row) -> str:
    """Return the subject of a claim: observable, point and series."""
    at = f"{subject} at {point.dataset.attrs['against']} {point.against:g}"
    return at + (f", {point.series}" if point.series else "")


def _claims_at(point: Row, stated: dict) -> Iterator[Claim]:
    """Yield the claim about a point, if it has the theory that is claimed. The half width and the required
    uncertainty of a claim of theory are fractions of the theoretical value.
    """
    that, expected = stated["that"], stated.get("value")
    common: dict[str, Any] = {"measured": point.value, "fails_if": stated["fails_if"]}
    if stated.get("required") is not None:
        common["required"] = stated["required"]
    if that != "theory":
        common |= {"claim": _text(point.observable, point), "source": stated["source"]}
        if that == "value":
            yield Claim.within(expected=expected, half_width=stated["tolerance"], **common)
        else:
            yield (Claim.at_least if that == "at_least" else Claim.at_most)(bound=expected, **common)
    elif not math.isnan(point.theory.value):
        theory, source = point.theory, point.source
        source = source or "the theory that `gaspart.analysis` has for this observable"
        common["claim"] = _text(f"{point.observable} compared with theory", point)
        common |= {"source": source, "required": stated["required"] * abs(theory.value)}
        if stated.get("tolerance") is not None:
            half = stated["tolerance"] * abs(theory.value)
            yield Claim.within(expected=theory.value, half_width=half, **common)
        elif math.isnan(theory.error):
            yield Claim(expected=theory.value, no_verdict=APPROXIMATE, **common)
        else:
            yield Claim(expected=theory, allowance_source=source, **common)


def _exponent(points: Table, stated: dict) -> Claim:
    """Return the claim on the exponent of a power law through a series; it is NaN without a fit."""
    x, y, series = points.against, points.value, points.series[0]
    measured = Estimate(math.nan, math.nan)
    if x.size > 2 and np.all(x > 0.0) and np.all(y.value > 0.0) and np.all(y.error > 0.0):
        measured = fit_power_law(x, y).estimate
    others = {"required": stated["required"]} if stated.get("required") is not None else {}
    subject = f"exponent of {points.observable} against {points.dataset.attrs['against']}"
    return Claim.within(
        subject + (f", {series}" if series else ""), measured, stated["value"], stated["tolerance"],
        stated["source"], stated["fails_if"], **others,
    )  # fmt: skip


_THEORY: dict[str, Any] = {"marker": "_", "markersize": 12, "linestyle": ":", "linewidth": 0.8, "zorder": 2}
"""Style of theory, which is known only at the points; thin lines connect these."""
_FEW = 3
"""Minimum number of points of a theoretical curve that are connected; fewer points are marked instead."""


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the observable of each series with theory, or a curve for each point."""
    points, settings = Table(dataset, "point"), json.loads(dataset.attrs["settings"])
    theory = settings.get("theory", True) and bool(np.isfinite(points.theory.value).any())
    figure, (axis,) = style.new((2.8,))
    (_draw_curves if "along_places" in dataset else _draw_numbers)(axis, points, theory)
    axis.set_ylabel(label_of(dataset["value"]))
    scales = settings.get("logarithmic", "none")
    if scales in ("x", "both"):
        axis.set_xscale("log")
    if scales in ("y", "both"):
        axis.set_yscale("log")
    axis.legend()
    return figure


def _draw_numbers(axis: Axes, points: Table, theory: bool) -> None:
    for kind, (series, part) in enumerate(points.by("series")):
        style.points(axis, part.against, part.value, kind=kind, label=series or "measured")
        if theory:
            axis.plot(part.against, part.theory.value, color=_colour(kind), **_THEORY)
    if theory:
        axis.plot([], [], color=style.GREY, label="theory", **_THEORY)
    axis.set_xlabel(_words(points.dataset.attrs["against"]))


def _draw_curves(axis: Axes, points: Table, theory: bool) -> None:
    """Draw curves with bands of one standard error, and theory in their colours."""
    look: dict[str, Any] = {"linestyle": "--", "zorder": 4}
    if (~np.isnan(points.theory.value)).sum(axis=1).max() < _FEW:  # like a contact value
        look = {"marker": "x", "linestyle": "none", "zorder": 4}
    for kind, point in enumerate(points):
        x, y, colour = point.along_places, point.value, _colour(kind)
        label = f"{_words(points.dataset.attrs['against'])} {point.against:g}"
        axis.plot(x, y.value, color=colour, label=f"{label}, {point.series}" if point.series else label)
        axis.fill_between(x, y.value - y.error, y.value + y.error, color=colour, alpha=0.3, linewidth=0)
        if theory:
            axis.plot(x, point.theory.value, color=colour, **look)
    if theory:
        axis.plot([], [], color=style.GREY, label="theory", **look)
    axis.set_xlabel(label_of(points.dataset["along_places"]))


def _colour(kind: int) -> str:
    return style.COLOURS[kind % len(style.COLOURS)]


FIGURES: dict[str, Parts] = {}
KINDS = {"observable": Parts(SETTINGS, measure, claims, draw)}
"""Parts of figures whose name the config chooses, by their `kind`."""
