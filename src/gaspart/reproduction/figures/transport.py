"""Viscosity and thermal conductivity from equilibrium, by Green and Kubo and by Helfand.

The runs of a point accumulated correlations of the stress and the heat flux. Coefficients are divided by
Enskog's values. Times are in collisions of a particle.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import combine_estimates, mean_of, means_of
from gaspart.analysis.transport import green_kubo, helfand
from gaspart.errors import SceneError
from gaspart.keys import positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import ENSKOG_LIMIT, PARTICLES, Parts
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.facts import plain_gas
from gaspart.trajectory.reading import open_trajectory

TITLE, CHAPTER = "Viscosity and conductivity", "Motion and its memory"
GROWTH = {
    "viscosity_from": positive("collisions of a particle from which on the integral's growth is compared"),
    "conductivity_from": positive("the same of the heat flux, which relaxes half as fast"),
}
COEFFICIENTS = {
    "viscosity": ("shear", theory.enskog_viscosity, r"$\eta/\eta_\mathrm{Enskog}$"),
    "conductivity": ("heat", theory.enskog_conductivity, r"$\lambda/\lambda_\mathrm{Enskog}$"),
}
"""Flux, Enskog's value, and label of each coefficient."""
LONGER = 2.0
"""Shortest length of waves (1 / wave number) in mean free paths. If only longer waves
count, the growth of the modes changes by the uncertainty of theory."""
LATE = 0.5
"""Fraction of the longest lag after which the squared change of Helfand's sum is assumed to grow linearly."""
_FORM: dict[str, Any] = {"inner": ("lag",), "units": {"time": "collisions per particle"}}


def measure_viscosity(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the shear viscosity, and `bulk`, the bulk viscosity, of each point."""
    return table("point", points, lambda point: coefficient(point, "viscosity") | _bulk(point), **_FORM)


def measure_conductivity(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure the thermal conductivity of each point."""
    return table("point", points, coefficient, "conductivity", **_FORM)


def _runs(point: Point) -> Iterator[tuple[Run, np.ndarray]]:
    """Yield each run, with the lags of its correlations."""
    for path in point.replica_paths:
        with open_trajectory(path) as trajectory:
            yield Run(point.scene, trajectory["time"].values, trajectory), trajectory["lag"].values


def coefficient(point: Point, name: str) -> dict[str, Any]:
    """Measure a coefficient by Green and Kubo (`value`, `running`) and by Helfand (`growth`). `difference` is
    growth over the integral's mean at the same lags, minus 1, from the same runs. `finite` is the coefficient
    of a dilute gas of as many particles over that of an infinite gas.
    """
    flux, enskog, _ = COEFFICIENTS[name]
    gas = plain_gas(point.scene)
    exact, rate = float(enskog(**gas.parameters)), float(theory.collision_rate(**gas.parameters))
    curves, growths = [], []
    for run, lags in _runs(point):
        curves += list(green_kubo(run, flux) / exact)
        growths += [_growth(lags, curve) for curve in helfand(run, flux) / exact]
    samples, growth, freedom = np.array(curves), np.array(growths), len(curves) - 1
    # equals the growth exactly, except for pairs at the ends
    meanwhile = samples[:, _half(lags) : -1].mean(axis=1)
    return {
        "dimension": gas.dimension,
        "packing_fraction": gas.packing_fraction,
        "count": gas.count,
        "finite": theory.transport_finite_size_factor(gas.count, gas.dimension, name),
        "value": Estimate(*means_of(samples[:, -1]), freedom),
        "growth": Estimate(*means_of(growth), freedom),
        "difference": Estimate(*means_of((growth - meanwhile) / meanwhile.mean()), freedom),
        "time": rate * _ends(lags),
        "running": means_of(samples),
    }


def _bulk(point: Point) -> dict[str, Estimate]:
    """Measure the bulk viscosity over Enskog's, up to the fraction `LATE` of the longest lag."""
    samples = []
    for run, lags in _runs(point):
        last = _half(lags)
        # The pressure's mean over a run of duration T reduces the value by the fraction 2 lag / T.
        short = 2.0 * lags[last] / (run.time[-1] - run.time[0])
        samples += list(green_kubo(run, "bulk")[:, last] / (1.0 - short))
    gas = plain_gas(point.scene)
    return {"bulk": mean_of(samples) / float(theory.enskog_bulk_viscosity(**gas.parameters))}


def _ends(lags: np.ndarray) -> np.ndarray:
    """Return the ends of the integrals: half an interval after the lags, as fluxes are means over those."""
    return lags + 0.5 * (lags[1] - lags[0])


def _half(lags: np.ndarray) -> int:
    """Return the lag from which on the growth is measured."""
    return round(LATE * (len(lags) - 1))


def _growth(lags: np.ndarray, slopes: np.ndarray) -> float:
    """Return half of the slope of the squared change; `slopes` are half of this change over each lag."""
    first = _half(lags)
    change = slopes * lags
    return float((change[-1] - change[first]) / (lags[-1] - lags[first]))


def measure_growth(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure integrals of discs up to each time, and how much they and the container's modes grow. `_modes`
    are shifted to the height of the integral where the comparison starts. `_short_waves` is the fraction of
    the growth that is due to waves of one to two mean free paths.
    """
    starts = {"viscosity": settings["viscosity_from"], "conductivity": settings["conductivity_from"]}
    return table("point", points, _growing, starts, **_FORM)


def _growing(point: Point, starts: dict[str, float]) -> dict[str, Any]:
    gas, lengths = plain_gas(point.scene), point.scene.container.lengths
    if gas.dimension != 2 or gas.diameter != 1.0 or gas.temperature != 1.0:
        raise SceneError(f"experiments.{point.experiment}", "gas", "must be discs of diameter and k_B T 1")
    eta, count = gas.packing_fraction, gas.count
    rate = float(theory.collision_rate(eta, 2))
    row: dict[str, Any] = {"count": count, "packing_fraction": eta}
    row["sound"] = rate * lengths[0] / float(theory.speed_of_sound(eta, 2))
    for name, (flux, enskog, _) in COEFFICIENTS.items():
        exact = float(enskog(**gas.parameters))
        curves, lags = zip(
            *((green_kubo(run, flux) / exact, lags) for run, lags in _runs(point)), strict=True
        )
        samples, time = np.concatenate(curves), _ends(lags[0])
        late = rate * time >= starts[name]
        modes, longer = (
            theory.transport_modes(time, eta, count, name, shortest)[late] / exact
            for shortest in (1.0, LONGER)
        )
        values, errors = means_of(samples)
        drawn = np.full(len(time), np.nan)
        drawn[late] = modes + np.mean(values[late] - modes)
        grown = samples[:, late]
        row["time"] = rate * time
        row[f"{name}_growth"] = mean_of(grown[:, -1] - grown[:, 0])
        row[f"{name}_modes_growth"] = modes[-1] - modes[0]
        row[name] = values, errors
        row[f"{name}_modes"] = drawn
        row[f"{name}_short_waves"] = 1.0 - (longer[-1] - longer[0]) / (modes[-1] - modes[0])
    return row


DILUTE_BAND = 0.01
"""Largest relative difference between a coefficient of a dilute gas and Enskog theory. At packing fraction
0.02, a particle collides again with a former partner in 2 of 100 collisions, which changes D by 0.6 %."""
ENSKOG = "Enskog's theory, with the Sonine polynomials that matter [Chapman 1970]"
ACCURATE, FEW_PER_CENT = 0.3, 0.05
"""Largest packing fraction at which Enskog's coefficients of spheres are accurate to a few per cent."""
BULK_IS_UNKNOWN = {
    2: "of discs its integral grows with the logarithm of time",
    3: "what correlated collisions do near freezing is not known",
}


def claim_viscosity(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on the shear and the bulk viscosity of spheres and discs."""
    yield from _claims(dataset, "viscosity")
    for gas in Table(dataset, "point"):
        is_known = _is_within(gas, {2: ENSKOG_LIMIT, 3: ACCURATE}[gas.dimension])
        yield Claim.within(
            f"bulk viscosity over Enskog's, {_which(gas)}", gas.bulk, 1.0, FEW_PER_CENT,
            "[Chapman 1970]; expansion changes what passes at contacts at once, and kinetic parts not",
            "a pressure that is not that of the contacts",
            no_verdict="" if is_known else BULK_IS_UNKNOWN[gas.dimension],
        )  # fmt: skip


def claim_conductivity(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on the thermal conductivity of spheres and discs."""
    return _claims(dataset, "conductivity")


def _is_within(gas: Row, packing_fraction: float) -> bool:
    """Return True if a gas has at most this packing fraction, except for rounding."""
    return bool(gas.packing_fraction <= packing_fraction * (1.0 + 1e-6))


def _which(gas: Row) -> str:
    particles = PARTICLES[gas.dimension]
    return f"{particles}, packing fraction {gas.packing_fraction:.3g}, {gas.count} particles"


def _claims(dataset: xr.Dataset, name: str) -> Iterator[Claim]:
    for gas in Table(dataset, "point"):
        if _is_within(gas, ENSKOG_LIMIT):
            yield Claim.within(
                f"{name} over Chapman and Enskog's, {_which(gas)}",
                gas.value / gas.finite, 1.0, DILUTE_BAND, ENSKOG,
                "a wrong flux, correlations cut too early, or a wrong effect of finite numbers",
            )  # fmt: skip
        elif gas.dimension == 3 and _is_within(gas, ACCURATE):
            yield Claim.within(
                f"{name} over Enskog's, {_which(gas)}", gas.value, 1.0, FEW_PER_CENT + 1.0 - gas.finite,
                f"{ENSKOG}; correlated collisions change it by a few per cent [Alder 1970b], the "
                "finite number as in a dilute gas",
                "a collisional part of the flux that is wrong or missing",
            )  # fmt: skip
        yield Claim.within(
            f"growth by Helfand over Green and Kubo's integral, {name}, {_which(gas)}",
            gas.difference + 1.0, 1.0, 0.01,
            "both are one double integral (exact), but for pairs at the ends of the runs",
            "sums that are not those of the same fluxes", kind="identity",
        )  # fmt: skip


def claim_growth(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on the logarithmic growth of discs' coefficients with time."""
    gases = Table(dataset, "point")
    for name in COEFFICIENTS:
        growth, modes, short_waves = (
            getattr(gases, f"{name}_{part}") for part in ("growth", "modes_growth", "short_waves")
        )
        yield Claim(
            f"growth of the {name}'s integral with time over that of the containers' modes",
            combine_estimates(growth / modes), Estimate(1.0, short_waves.max()), 0.25,
            "mode coupling [Ernst 1971] with delayed vertices and relaxing fluxes, the modes of the "
            "containers (gaspart.theory.mode_pairs)",
            f"a flux without a 1/t tail, so that the {name} exists",
            allowance_source="waves of one to two mean free paths, which are hardly modes", alternative=0.0,
        )  # fmt: skip


SHOWN_FROM = 4.0
"""Collisions of a particle after which the integrals are close to their final values, and fit on the axis."""


def _drawing(name: str) -> Callable[[xr.Dataset], Figure]:
    """Return the function that draws a coefficient against density, and the running integrals."""

    def draw(dataset: xr.Dataset) -> Figure:
        gases = Table(dataset, "point")
        present = [dimension for dimension in (3, 2) if (gases.dimension == dimension).any()]
        figure, axes = style.new(*[(2.4,)] * 2 * len(present))
        for n, dimension in enumerate(present):
            own = gases[gases.dimension == dimension].sorted_by("packing_fraction")
            _draw_values(axes[2 * n], own)
            _draw_running(axes[2 * n + 1], own)
            for axis in axes[2 * n : 2 * n + 2]:
                axis.set_ylabel(f"{COEFFICIENTS[name][2]}, {PARTICLES[dimension]}")
        style.letters(*axes)
        return figure

    return draw


def _draw_values(axis: Axes, gases: Table) -> None:
    eta, shift = gases.packing_fraction, 0.004
    style.points(axis, eta - shift, gases.value, kind=0, label="Green-Kubo")
    style.points(axis, eta + shift, gases.growth, kind=1, hollow=True, label="Helfand")
    if "bulk" in gases.dataset:
        style.points(axis, eta, gases.bulk, kind=2, label="bulk, Green-Kubo")
    axis.axhline(1.0, color=style.GREY, lw=0.8, label="Enskog")
    axis.set_xlim(0.0, 1.1 * eta.max())
    style.label_axes(axis, r"packing fraction $\phi$", legend="upper left")


def _draw_running(axis: Axes, gases: Table) -> None:
    for kind, gas in enumerate(gases[:: max(1, len(gases) // 4)]):
        style.points(axis, gas.time, gas.running, kind=kind, label=rf"$\phi={gas.packing_fraction:.3g}$")
    axis.axhline(1.0, color=style.GREY, lw=0.8)
    axis.set_xlim(0.0)
    style.label_axes(axis, r"collisions per particle $\nu t$", legend="lower right", columns=2)


def draw_growth(dataset: xr.Dataset) -> Figure:
    """Draw the integrals of both fluxes of discs against the logarithm of time, by container."""
    figure, axes = style.new((2.4,), (2.4,))
    gases = Table(dataset, "point")
    late = (gases.time >= SHOWN_FROM).all(axis=0)
    for axis, (name, (*_, label)) in zip(axes, COEFFICIENTS.items(), strict=True):
        axis.set_xscale("log")
        for kind, gas in enumerate(gases):
            time = gas.time[late]
            style.points(axis, time, gas[name][late], kind=kind, label=f"{gas.count} discs")
            axis.plot(time, gas[f"{name}_modes"][late], color=style.COLOURS[kind], lw=1.2)
        axis.plot([], [], color=style.GREY, lw=1.2, label="modes of the container")
        style.label_axes(axis, r"collisions per particle $\nu t$", f"{label}, discs", "lower right")
    style.letters(*axes)
    return figure


FIGURES = {
    "viscosity": Parts({}, measure_viscosity, claim_viscosity, _drawing("viscosity")),
    "conductivity": Parts({}, measure_conductivity, claim_conductivity, _drawing("conductivity")),
    "logarithmic_growth": Parts(GROWTH, measure_growth, claim_growth, draw_growth),
}
