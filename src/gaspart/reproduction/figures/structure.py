r"""Structure of spheres and discs: g(r), S(k), and two numbers by several methods.

- The compressibility: by S(k) extrapolated to k = 0, and by :math:`1 / (d(\eta Z)/d\eta)` of the measured
  equation of state. 1 / S(k) = 1 - rho c(k), with the direct correlation function c. Its range is about one
  diameter. Therefore c(k) is an even power series that converges fast for k up to a few inverse diameters. 1
  / S is fitted by a polynomial in :math:`k^2` of order three, at all wave vectors of the container.
- The contact value of N particles: by g(r) extrapolated to the diameter, by the collisional virial,
  :math:`(Z_N - 1) / (2^{d-1} \eta)`, and by the collision rate divided by the rate of independent particles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.pairs import radial_distribution
from gaspart.analysis.run import Run
from gaspart.analysis.series import Blocks
from gaspart.analysis.statistics import fit_polynomial, jackknife, means_of
from gaspart.analysis.structure_factors import factors, in_shells, shells_of, wave_vectors
from gaspart.keys import count, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import PARTICLES, Parts, runs, series_of
from gaspart.reproduction.figures.chemical_potential import (
    MEASURED,
    MeasuredState,
    measured_states,
    spheres_and_discs,
    where,
)
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.facts import Gas, plain_gas
from gaspart.theory.structure import percus_yevick_rdf, percus_yevick_structure_factor

TITLE, CHAPTER = "Structure and chemical potential", "Equation of state and structure"
SETTINGS = {
    "measured": MEASURED,
    "small": positive("wave number times the diameter up to which S(k) is fitted, to extrapolate to 0"),
    "highest": positive("wave number times the diameter up to which S(k) is drawn"),
    "furthest": positive("distance in diameters up to which g(r) is drawn", maximum=4.5),
    "frames": count("frames of each run that are used for the curves", minimum=20),
}
BLOCKS = 10  # of each run; their scatter determines the errors
ORDERS = (0, 2, 4, 6)  # powers of k in the fit of 1 / S(k)
WIDTH = 0.005  # of the bins of g(r) at contact, in diameters
# Range of the fit of g(r) at contact, times the contact value: g decreases nearly equally in all ranges.
WINDOW = 0.45
BINS, SHELLS, WAVES = 160, 80, 24  # drawn bins of g(r) and S(k); wave vectors in each bin of S(k)
LAWS = {  # Verlet-Weis, Percus-Yevick
    "g": (theory.verlet_weis_rdf, percus_yevick_rdf),
    "s": (theory.verlet_weis_structure_factor, percus_yevick_structure_factor),
}


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure g(r), S(k) and derived numbers at each point of the experiments `measured`. Contact values are
    times (N - 1) / N. `g_gain` and `s_gain` are root mean square distances of curves of spheres from
    Verlet-Weis over those from Percus-Yevick.
    """
    measured = [point for point in points if point.experiment in settings["measured"]]
    inner = {"g": ("bin",), "distance": ("bin",), "s": ("shell",), "wave_number": ("shell",)}
    return table("point", measured, _row, measured_states(points), settings, inner=inner)


def _row(point: Point, states: dict[int, MeasuredState], settings: dict) -> dict[str, Any]:
    gas = plain_gas(point.scene)
    eta, dimension = gas.packing_fraction, gas.dimension
    lengths = np.array(point.scene.container.lengths) / gas.diameter
    low, size = wave_vectors(lengths, settings["small"])
    waves, shell, k = shells_of(lengths, settings["highest"], SHELLS, WAVES)
    furthest = min(settings["furthest"], 0.499 * float(lengths.min()))
    curves = waves, shell, furthest
    parts = [_blocks(run, gas, low, curves, settings["frames"]) for run in runs(point)]
    s_low, near, g, s, z, rate = (np.concatenate(series) for series in zip(*parts, strict=True))
    row: dict[str, Any] = {"dimension": dimension, "packing_fraction": eta, "count": gas.count}
    row |= _compressibility(s_low, size, states[dimension].inverse_compressibility(eta))
    row |= _contact_values(near, z, rate, gas)
    distance = furthest * (np.arange(BINS) + 0.5) / BINS
    if dimension == 3:
        row["g_gain"] = _gain(g, *(law(distance, eta) for law in LAWS["g"]))
        row["s_gain"] = _gain(s, *(law(k, eta) for law in LAWS["s"]))
    return row | {"g": means_of(g), "s": means_of(s), "distance": distance, "wave_number": k}


def _blocks(run: Run, gas: Gas, low: np.ndarray, curves: tuple, most: int) -> tuple[np.ndarray, ...]:
    """Return means over each block: S at `low`, g near contact, the drawn curves, Z, and collision rate.
    `curves` has wave vectors, their shells, and the largest distance. The curves use about `most` frames.
    """
    parts, series = Blocks(run, BLOCKS), series_of(run)
    sides = np.array(run.scene.container.lengths) / gas.diameter
    blocks = np.split(run.positions[parts.frames] / gas.diameter, BLOCKS)
    stride = max(1, (len(run.positions) - 1) // most)
    few = [frames[::stride] for frames in blocks]
    waves, shell, furthest = curves
    rounding = 2.0**-18  # so that pairs in contact are not below the first bin

    def g(frames: np.ndarray, bins: int, end: float) -> np.ndarray:
        pairs = gas.count / (gas.count - 1.0)
        return pairs * radial_distribution(frames, sides, bins, end)[1]

    def s(frames: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        return np.asarray(factors(frames, sides, vectors).mean(axis=0))

    contact = round(1.0 / WIDTH)
    return (
        np.array([s(frames, low) for frames in blocks]),
        np.array([g(frames, round(1.5 / WIDTH), 1.5 - rounding)[contact:] for frames in blocks], float),
        np.array([g(frames, BINS, furthest) for frames in few], float),
        np.array([in_shells(s(frames, waves), shell) for frames in few]),
        parts.means(series.z),
        parts.means(series.rate),
    )


def _each(function: Callable[..., float], *series: np.ndarray) -> Estimate:
    return Estimate(*jackknife(function, *series), len(series[0]) - 1)


def _compressibility(low: np.ndarray, size: np.ndarray, inverse: Estimate) -> dict[str, Estimate]:
    """Extrapolate S at wave numbers `size` (M,) to 0, beside the equation of state."""
    k, equal, number = np.unique(size.round(9), return_inverse=True, return_counts=True)
    low = np.array([in_shells(values, equal) for values in low])
    spread = 1.0 / (low.mean(axis=0) * np.sqrt(number))  # weights of 1 / S, up to a factor
    s0 = _each(lambda s: 1.0 / float(fit_polynomial(k, 1.0 / s, spread, powers=ORDERS).values[0]), low)
    return {"s0": s0, "state_s0": 1.0 / inverse, "s0_ratio": s0 / (1.0 / inverse)}


def _contact_values(near: np.ndarray, z: np.ndarray, rate: np.ndarray, gas: Gas) -> dict[str, Estimate]:
    unit = 1.0 / (2.0 ** (gas.dimension - 1) * gas.packing_fraction)
    per_rate = _contact_per_rate(gas)
    contact = (z.mean() - 1.0) * unit
    first = max(len(ORDERS) + 2, round(WINDOW / contact / WIDTH))
    distance = WIDTH * (np.arange(first) + 0.5)
    pairs = np.sqrt(near[:, :first].mean(axis=0)) / (1.0 + distance) ** (0.5 * (gas.dimension - 1))

    def of_g(near: np.ndarray) -> float:
        fit = fit_polynomial(distance, near[:first], pairs, powers=(0, 1, 2, 3))
        return float(fit.values[0]) * (1.0 - 1.0 / gas.count)

    def of_z(z: float) -> float:
        return (z - 1.0) * unit

    return {
        "contact_g": _each(of_g, near),
        "contact_z": _each(of_z, z),
        "contact_rate": _each(lambda rate: rate * per_rate, rate),
        "g_ratio": _each(lambda near, z: of_g(near) / of_z(z), near, z),
        "rate_ratio": _each(lambda rate, z: rate * per_rate / of_z(z), rate, z),
    }


def _contact_per_rate(gas: Gas) -> float:
    """Compute the contact value times (N - 1) / N over the reduced collision rate. This ratio is exact for N
    particles. The reference equation of state cancels.
    """
    eta, dimension, count = gas.packing_fraction, gas.dimension, gas.count
    excess = theory.compressibility_factor(eta, dimension) - 1.0
    excess += theory.finite_size_correction(eta, dimension, count, "canonical")
    rate = theory.collision_rate(eta, dimension)
    rate *= theory.collision_rate_finite_size_factor(eta, dimension, count)
    return float(excess / (2.0 ** (dimension - 1) * eta * rate))


def _gain(samples: np.ndarray, better: np.ndarray, worse: np.ndarray) -> Estimate:
    """Compute the distance of the mean of samples (B, n) from one theory over another."""

    def gain(mean: np.ndarray) -> float:
        near, far = (float(((mean - law) ** 2).sum()) for law in (better, worse))
        return float(np.sqrt(near / far))

    return _each(gain, samples)


AGREE = 0.005  # largest standard error at which an agreement to 1 % is conclusive
# From this packing fraction on, compressibility and contact value of the Percus-Yevick theory of spheres
# differ by 4 % and more, which exceeds the errors of the measurement; from the second one on its curves
# differ everywhere, relative to their noise.
DENSE, DENSEST = 0.25, 0.4


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims that methods agree on compressibility and contact value, and on Verlet-Weis curves."""
    for fluid in Table(dataset, "point"):
        eta, spheres = fluid.packing_fraction, fluid.dimension == 3
        yevick = {
            "compressibility": (1.0 - eta) ** 4 / (1.0 + 2.0 * eta) ** 2 / fluid.state_s0.value,
            "contact": (1.0 + 0.5 * eta) / (1.0 - eta) ** 2 / fluid.contact_z.value,
        }
        yield Claim(
            f"S(0) over the compressibility of the measured equation of state, {where(fluid)}",
            fluid.s0_ratio, 1.0, AGREE, "S(0) = k T dρ/dP, the fluctuation of the number (exact)",
            "wave vectors that the container does not admit, too few independent frames, an "
            "extrapolation that does not hold, or a wrong pressure",
            alternative=yevick["compressibility"] if spheres and eta >= DENSE else None,
        )  # fmt: skip
        yield Claim(
            f"contact value from g(r) over that from Z, {where(fluid)}", fluid.g_ratio, 1.0, AGREE,
            "the virial theorem: Z = 1 + 2^(d-1) η g(σ) (exact)",
            "frames that are no sample of what the collisions see, pairs that are counted wrongly, "
            "or a wrong pressure",
            alternative=yevick["contact"] if spheres and eta >= DENSE else None,
        )  # fmt: skip
        yield Claim(
            f"contact value from the collision rate over that from Z, {where(fluid)}",
            fluid.rate_ratio, 1.0, AGREE,
            "velocities are independent of positions: the rate is g(σ) times that of independent "
            "particles (exact, for N particles of a fixed energy)",
            "collisions missed, or relative speeds at contact that are not Maxwellian",
            follows=True,
        )  # fmt: skip
        gains = {"g(r)": fluid.g_gain, "S(k)": fluid.s_gain} if spheres and eta >= DENSEST else {}
        for name, gain in gains.items():
            yield Claim.at_most(
                f"distance of {name} from Verlet and Weis's over that from Percus and Yevick's, "
                f"{where(fluid)}",
                gain, 0.5, 0.1,
                "[Verlet 1972] corrects the contact value and the phase of [Percus 1958]; one half is "
                "chosen here",
                "a wrong phase or height of the maxima, measured or computed",
            )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw g(r) and S(k) of the densest fluids with theory, and ratios of methods."""
    figure, axes = style.new((2.3,), (2.3,), (2.3,), (2.3,))
    g, s, zero, contact = axes
    for kind, fluids in enumerate(spheres_and_discs(dataset)):
        if fluids:
            _curves(g, s, fluids[-1], kind)
            _ratios(zero, fluids, kind, {"$S(0)$": fluids.s0_ratio})
            _ratios(contact, fluids, kind, {"$g(r)$": fluids.g_ratio, "rate": fluids.rate_ratio})
    for axis in (zero, contact):
        style.band(axis, 0.99, 1.01)
        style.level(axis, 1.0)
    density = r"packing fraction $\eta$"
    style.label_axes(g, r"distance $r/\sigma$", "$g(r)$", "best", xlim=(0.9, None))
    style.label_axes(s, r"wave number $k\sigma$", "$S(k)$", "best", xlim=(0.0, None))
    style.label_axes(zero, density, r"$S(0)$ / ($kT\,\mathrm{d}\rho/\mathrm{d}P$)", "best", xlim=(0.0, None))
    style.label_axes(contact, density, r"$g(\sigma)$ / $g(\sigma)$ from $Z$", "best", xlim=(0.0, None))
    style.letters(*axes)
    return figure


def _curves(g: Axes, s: Axes, fluid: Row, kind: int) -> None:
    eta, distance, wave_number = fluid.packing_fraction, fluid.distance, fluid.wave_number
    beyond, finite = distance >= 1.0, np.isfinite(fluid.s.value)
    small: dict[str, Any] = {"kind": kind, "hollow": True, "markersize": 2.0}
    small["label"] = rf"{PARTICLES[fluid.dimension]}, $\eta={eta:.2g}$"
    style.points(g, distance[beyond], fluid.g[beyond], **small)
    style.points(s, wave_number[finite], fluid.s[finite], **small)
    if fluid.dimension == 3:
        r = np.linspace(1.0, distance.max(), 300)
        k = np.linspace(0.0, np.nanmax(wave_number), 300)
        for n, name in enumerate(("Verlet–Weis", "Percus–Yevick")):
            look: dict[str, Any] = {"color": "black", "linestyle": ("-", "--")[n], "label": name}
            g.plot(r, LAWS["g"][n](r, eta), **look)
            s.plot(k, LAWS["s"][n](k, eta), **look)


def _ratios(axis: Axes, fluids: Table, kind: int, ratios: dict[str, Estimate]) -> None:
    for n, (name, ratio) in enumerate(ratios.items()):
        # Shifted, so that points of several methods do not overlap.
        eta = fluids.packing_fraction + 0.006 * (kind - 0.5 + 0.4 * n)
        look: dict[str, Any] = {"hollow": n == 1, "color": style.COLOURS[kind]}
        style.points(axis, eta, ratio, kind=kind, label=f"{name}, {PARTICLES[fluids.dimension[0]]}", **look)


FIGURES = {"structure": Parts(SETTINGS, measure, claims, draw)}
