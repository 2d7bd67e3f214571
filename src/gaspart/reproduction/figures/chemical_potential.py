r"""Chemical potential and partition function, by insertion and by a fit to the measured equation of state.

:math:`Z(\eta) = Z_\mathrm{ref}(\eta)\,(1 + c_1 \eta + c_2 \eta^2 + c_3 \eta^3)` is fitted to the measured
values. The reference serves only for interpolation between them. The compressibility, the free energy and the
chemical potential then follow by thermodynamics. They are linear in the coefficients.

Source C writes the partition function as :math:`V^N Q / (h^{dN} N!)\,(2\pi m k_B T)^{dN/2}` (Eqs. 41 to
46). Only the configuration integral Q is unknown. If N particles are in place, a further particle at a
random position overlaps no other particle with the probability :math:`Q_{N+1}/Q_N`. Therefore ln Q is the
sum of the logarithms of these probabilities over all smaller numbers in one container. Per particle, it is
minus the mean of mu_excess / k_B T over all lower packing fractions. By the equation of state it is minus
the integral of (Z - 1) / eta.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart import theory
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.insertion import Insertions, insertions
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import Fit, average, correlated_mean, fit_polynomial
from gaspart.keys import count, names
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import PARTICLES, SOURCE_C, Parts, pressure, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.facts import plain_gas
from gaspart.theory.tables import chemical_potential_uncertainty, insertion_finite_size_correction

TITLE, CHAPTER = "Structure and chemical potential", "Equation of state and structure"
MEASURED = names("the experiments whose frames are measured; of the others Z alone")
SETTINGS = {
    "measured": MEASURED,
    "trials": count("positions that are tried in each frame"),
    "frames": count("frames of each run that are used", minimum=20),
    "enough": count("frames with a free place from which on their mean counts as Gaussian"),
}
STATE_POWERS = (1, 2, 3)  # of eta in Z / Z_ref - 1
POTENTIAL_POWERS = (0, 1, 2)  # of eta in the measured chemical potential over the reference
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)  # integrands are polynomials except for the reference


@dataclass(frozen=True)
class MeasuredState:
    """Equation of state of one dimension, by a fit to measured Z / Z_ref - 1."""

    dimension: int
    fit: Fit

    def _estimate(self, reference: float, factors: list[float]) -> Estimate:
        """Return a quantity of the reference plus the contribution of each coefficient. The degrees of
        freedom of the error are the smallest of the coefficients.
        """
        parts = np.array(factors)
        error = np.sqrt(parts @ self.fit.covariance @ parts)
        return Estimate(reference + parts @ self.fit.values, error, self.fit.freedoms.min())

    def inverse_compressibility(self, eta: float) -> Estimate:
        """Compute d(eta Z) / d eta."""
        z = float(theory.compressibility_factor(eta, self.dimension))
        slope = 1.0 / float(theory.reduced_compressibility(eta, self.dimension))
        return self._estimate(slope, [eta**n * (slope + n * z) for n in STATE_POWERS])

    def _integral(self, eta: float, power: int) -> float:
        """Integrate Z_ref eta'^(power - 1) from 0 to eta."""
        inner = 0.5 * eta * (NODES + 1.0)
        z = theory.compressibility_factor(inner, self.dimension)
        return float(0.5 * eta * WEIGHTS @ (z * inner ** (power - 1)))

    def free_energy(self, eta: float) -> Estimate:
        """Compute f_excess / (N k_B T), the integral of (Z - 1) / eta."""
        reference = float(theory.excess_free_energy(eta, self.dimension))
        return self._estimate(reference, [self._integral(eta, n) for n in STATE_POWERS])

    def chemical_potential(self, eta: float) -> Estimate:
        """Compute mu_excess / (k_B T) by the Gibbs-Duhem relation: Z - 1 plus the free energy."""
        z = float(theory.compressibility_factor(eta, self.dimension))
        reference = float(theory.excess_chemical_potential(eta, self.dimension))
        return self._estimate(reference, [z * eta**n + self._integral(eta, n) for n in STATE_POWERS])


def measured_states(points: list[Point]) -> dict[int, MeasuredState]:
    """Return the equation of state of each dimension, from all its points in the fluid range."""
    highest = theory.HIGHEST_PACKING_FRACTION
    fluids = [point for point in points if point.scene.packing_fraction <= highest[point.scene.dimension]]
    states = {}
    for dimension, own in Table(table("point", fluids, _excess), "point").by("dimension"):
        fit = fit_polynomial(own.packing_fraction, own.excess, powers=STATE_POWERS)
        states[dimension] = MeasuredState(dimension, fit)
    return states


def _excess(point: Point) -> dict[str, Any]:
    """Return Z / Z_ref - 1 of a point, for the infinite system."""
    gas = plain_gas(point.scene)
    state = gas.packing_fraction, gas.dimension
    shift = float(theory.finite_size_correction(*state, gas.count, ensemble="canonical"))
    reference = float(theory.compressibility_factor(*state))
    excess = (pressure(point).z - shift) / reference - 1.0
    return {"dimension": gas.dimension, "packing_fraction": gas.packing_fraction, "excess": excess}


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure mu_excess / (k_B T) and ln Q / N at each point of `measured`, by insertion and Gibbs-Duhem.
    `inserted` is for the infinite fluid, `expected`, the probability that a place is free by the equation of
    state, for this number of particles. A row `works` with `enough` frames that have a free place; `ln_q` is
    NaN if it does not.
    """
    states = measured_states(points)
    measured = [point for point in points if point.experiment in settings["measured"]]
    measured.sort(key=lambda point: (point.scene.dimension, point.scene.packing_fraction))
    rows = [_row(point, states[point.scene.dimension], settings) for point in measured]
    for dimension, state in states.items():
        works = [row for row in rows if row["dimension"] == dimension and row["works"]]
        if len(works) >= len(POTENTIAL_POWERS):
            _add_partition(works, state)
    return table("point", rows, dict, of=measured).assign_attrs(enough=settings["enough"])


def _row(point: Point, state: MeasuredState, settings: dict) -> dict[str, Any]:
    gas = plain_gas(point.scene)
    eta, dimension = gas.packing_fraction, gas.dimension
    replicas = [_insert(run, gas.diameter, settings, point.seed(k)) for k, run in enumerate(runs(point))]
    hits = sum(int(np.count_nonzero(replica.successes)) for replica in replicas)
    frames = sum(len(replica.share) for replica in replicas)
    chance = average([_chance(replica) for replica in replicas])
    finite = float(insertion_finite_size_correction(eta, dimension, gas.count))
    integrated = state.chemical_potential(eta)
    inserted = _minus_log(chance) - finite
    expected = math.exp(-integrated.value - finite)
    resolution = sum(replica.resolution * len(replica.share) ** 2 for replica in replicas) / frames**2
    stated = theory.excess_chemical_potential, chemical_potential_uncertainty
    return {
        "dimension": dimension,
        "packing_fraction": eta,
        "count": gas.count,
        "probability": chance,
        "expected": Estimate(expected, expected * integrated.error, integrated.freedom),
        "inserted": inserted,
        "integrated": integrated,
        "ratio": inserted / integrated,
        "reference": tuple(float(number(eta, dimension)) for number in stated),
        "successes": sum(int(replica.successes.sum()) for replica in replicas),
        "hit_frames": hits,
        "frames": frames,
        "resolution": resolution,  # probability that corresponds to a single success
        "works": int(hits >= settings["enough"]),
    }


def _insert(run: Run, diameter: float, settings: dict, seed: tuple[int, ...]) -> Insertions:
    """Try insertions in evenly spaced frames of a run."""
    positions = run.positions[1:]
    stride = -(-len(positions) // settings["frames"])
    lengths = run.scene.container.lengths
    return insertions(positions[::stride], lengths, [(slice(None), diameter)], settings["trials"], seed)


def _chance(insertions: Insertions) -> Estimate:
    """Average over frames; without a success the error is the resolution."""
    if not insertions.successes.any():
        return Estimate(0.0, insertions.resolution)
    return correlated_mean(insertions.probability).estimate


def _minus_log(chance: Estimate) -> Estimate:
    if chance.value == 0.0:
        return Estimate(math.nan, math.nan)
    return Estimate(-math.log(chance.value), chance.error / chance.value, chance.freedom)


def _add_partition(rows: list[dict[str, Any]], state: MeasuredState) -> None:
    eta = np.array([row["packing_fraction"] for row in rows])
    logarithms = ln_q(eta, Estimate.stack([row["inserted"] for row in rows]), state.dimension)
    for row, inserted in zip(rows, logarithms, strict=True):
        integrated = state.free_energy(row["packing_fraction"])
        row |= {"ln_q": inserted, "ln_q_integrated": integrated, "ln_q_ratio": inserted / integrated}


def ln_q(eta: np.ndarray, potential: Estimate, dimension: int) -> Estimate:
    """Compute minus ln Q / N at packing fractions eta (n,) from excess chemical potentials. The reference
    times a polynomial in eta is fitted to the potentials. Its integral over eta is divided by eta. The
    degrees of freedom of the errors are the smallest of the coefficients.
    """
    reference = theory.excess_chemical_potential(eta, dimension)
    fit = fit_polynomial(eta, potential / reference - 1.0, powers=POTENTIAL_POWERS)
    inner = 0.5 * eta[:, None] * (NODES + 1.0)
    curve = 0.5 * WEIGHTS * theory.excess_chemical_potential(inner, dimension)
    parts = np.stack([(curve * inner**power).sum(axis=1) for power in POTENTIAL_POWERS], axis=1)
    errors = np.sqrt(((parts @ fit.covariance) * parts).sum(axis=1))
    return Estimate(curve.sum(axis=1) + parts @ fit.values, errors, fit.freedoms.min())


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on insertion beside Gibbs-Duhem, on where it fails, and on Q."""
    fluids = Table(dataset, "point")
    for fluid in fluids:
        yield _works(fluid) if fluid.works else _fails(fluid, fluids.enough)
    for dimension in (3, 2):
        own = fluids[(fluids.dimension == dimension) & (fluids.works == 1)]
        if len(own) < 2:
            continue
        yield Claim.joint(
            f"chemical potential by insertion of {PARTICLES[dimension]}, all packing fractions",
            (own.inserted - own.reference).deviation,
            "the integral of the reference equation of state ([Kolafa 2004], [Clisby 2006])",
            "a bias too small for one point is common to many, or the error bars are wrong",
        )  # fmt: skip
        densest = own[-1]
        if np.isfinite(densest.ln_q_ratio.value):
            yield Claim(
                f"ln Q / N by insertion over that of the measured equation of state, {where(densest)}",
                densest.ln_q_ratio, 1.0, 0.01,
                f"{SOURCE_C}, Eq. 46: both are the free energy beyond an ideal gas's (exact)",
                "insertion or the pressure is wrong at a lower density", follows=True,
            )  # fmt: skip


def where(fluid: Row) -> str:
    """Return the point of a claim in words."""
    return f"{PARTICLES[fluid.dimension]}, packing fraction {fluid.packing_fraction:.3g}"


def _works(fluid: Row) -> Claim:
    return Claim(
        f"chemical potential by insertion over that of the equation of state, {where(fluid)}",
        fluid.ratio, 1.0, 0.01,
        "[Widom 1963] and the equation of Gibbs and Duhem, with the measured Z (both exact)",
        "places that are not uniform, overlaps that are missed, correlated frames that are "
        "counted as independent, or a wrong pressure",
    )  # fmt: skip


def _fails(fluid: Row, enough: int) -> Claim:
    return Claim(
        f"chance of an insertion over that of the equation of state, {where(fluid)}",
        fluid.probability / fluid.expected.value, 1.0, 1.0,
        f"as where it works; the chemical potential is {fluid.reference.value:.3g} k T",
        "places that are not uniform, or overlaps that are missed",
        no_verdict=f"only {fluid.hit_frames} of {fluid.frames} frames have a free place ({enough} are asked "
        "for): their number is no Gaussian one",
    )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the chemical potential, its ratio by both methods, the insertion probability, and ln Q / N."""
    figure, axes = style.new((2.3, 1.6), (2.3,), (2.3,))
    upper, ratio, chance, partition = axes
    style.band(ratio, 0.99, 1.01)
    style.level(ratio, 1.0)
    for kind, fluids in enumerate(spheres_and_discs(dataset)):
        if fluids:
            _potential(upper, ratio, fluids, kind)
            _chances(chance, fluids, kind)
            _partition(partition, fluids, kind)
    density = r"packing fraction $\eta$"
    style.label_axes(upper, y=r"$\mu_\mathrm{excess}/kT$", legend="best")
    style.label_axes(ratio, density, "insertion / integral", xlim=(0.0, None), ylim=(0.97, 1.03))
    chance.set(yscale="log", xlim=(0.0, None), ylim=(1e-16, 3.0))  # with space for the legend
    style.label_axes(chance, density, "probability of insertion", "lower left")
    style.label_axes(partition, density, r"$-\ln Q/N$", "best", xlim=(0.0, None))
    style.letters(*axes)
    return figure


def spheres_and_discs(dataset: xr.Dataset) -> list[Table]:
    """Return the spheres and the discs, both in order of ascending packing fraction."""
    fluids = Table(dataset, "point")
    return [fluids[fluids.dimension == dimension].sorted_by("packing_fraction") for dimension in (3, 2)]


def _potential(upper: Axes, ratio: Axes, fluids: Table, kind: int) -> None:
    dimension, colour = fluids.dimension[0], style.COLOURS[kind]
    eta = np.linspace(0.0, fluids.packing_fraction.max(), 200)
    curve = theory.excess_chemical_potential(eta, dimension)
    upper.plot(eta, curve, color=colour, label=f"{PARTICLES[dimension]}, integral")
    label = f"{PARTICLES[dimension]}, insertion"
    style.points(upper, fluids.packing_fraction, fluids.inserted, kind=kind, label=label)
    style.points(ratio, fluids.packing_fraction, fluids.ratio, kind=kind)
    if dimension == 3:
        eta, curve = eta[1:], curve[1:]
        integral = (4.0 * eta - 3.0 * eta**2) / (1.0 - eta) ** 2
        starling = integral + theory.carnahan_starling(eta) - 1.0
        ratio.plot(eta, starling / curve, color=colour, linestyle="--", linewidth=0.8)


def _chances(axis: Axes, fluids: Table, kind: int) -> None:
    """Draw the insertion probability, its theory, and the smallest measurable probability."""
    dimension, colour = fluids.dimension[0], style.COLOURS[kind]
    eta = np.linspace(0.0, fluids.packing_fraction.max(), 200)
    axis.plot(eta, np.exp(-theory.excess_chemical_potential(eta, dimension)), color=colour)
    some = fluids[fluids.probability.value > 0.0]
    style.points(axis, some.packing_fraction, some.probability, kind=kind, label=PARTICLES[dimension])
    look: dict[str, Any] = {"color": colour, "marker": "_", "linestyle": ":", "linewidth": 0.8}
    label = f"one success, {PARTICLES[dimension]}"
    axis.plot(fluids.packing_fraction, fluids.resolution, label=label, **look)


def _partition(axis: Axes, fluids: Table, kind: int) -> None:
    dimension = fluids.dimension[0]
    eta = np.linspace(0.0, fluids.packing_fraction.max(), 200)
    label = f"{PARTICLES[dimension]}, integral"
    axis.plot(eta, theory.excess_free_energy(eta, dimension), color=style.COLOURS[kind], label=label)
    if "ln_q" in fluids.dataset:
        style.points(axis, fluids.packing_fraction, fluids.ln_q, kind=kind)


FIGURES = {"chemical_potential": Parts(SETTINGS, measure, claims, draw)}
