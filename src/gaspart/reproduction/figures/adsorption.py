"""Adsorption on a wall: amount, coverage, and speeds of the particles that leave it.

The wall x_low has a potential well, or is sticky; x_high is thermal. A well is "ideal" (wide, dilute), or
holds a "layer" (it is narrower than a particle). Replicas are cut into blocks; errors are jackknife errors.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import combine_estimates, fit_polynomial, fit_power_law
from gaspart.keys import count, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim
from gaspart.reproduction.figure import Blocks, Parts, runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, table
from gaspart.scene.boundaries import thermal_face
from gaspart.scene.surfaces import Well
from gaspart.theory.equations import STABLE_DISCS
from gaspart.theory.geometry import Numbers, Values, checked_packing_fraction, particle_volume
from gaspart.theory.state import compressibility_factor
from gaspart.theory.tables import excess_chemical_potential, packing_fraction_at

TITLE, CHAPTER = "Walls that hold particles", "Gravity, heat and walls"
SETTINGS = {
    "blocks": count("stretches of each replica"),
    "layer_blocks": count("the same of layers, in whose deep wells particles stay long"),
    "near": positive(
        "distance from the edge of the well, or from where particles stick, within which the velocities of "
        "leaving particles are read"
    ),
    "bins": count("bins of their speeds"),
}
KINDS = ("ideal", "layer", "sticky")

# Theory. Energies are in kT. A particle is in a well of width w if its centre is less than w above the lowest
# position that it can reach.

_EXACT = np.sqrt(0.75)  # any higher point is within a diameter, 1, of at most one centre in a layer


def well_ratio(depth: Numbers, width: Numbers, outside: Numbers) -> Values:
    """Compute N_ads / N_gas of an ideal gas in equilibrium with a step well."""
    return width / outside * np.exp(depth)


def excess_in_well(held: Numbers, free: Numbers, diameter: float, width: float, outside: float) -> Values:
    """Compute ln of the ratio N_ads / N_gas of spheres, relative to an ideal gas, from both densities."""
    ball, beyond = particle_volume(3, 2.0 * diameter), 0.25 * np.pi * diameter**4
    in_well = held * (ball - 2.0 * beyond / width) + free * beyond / width
    in_gas = free * (ball - 2.0 * beyond / outside) + held * beyond / outside
    return in_gas - in_well


def planck_constant(length: Numbers, mass: Numbers, temperature: Numbers) -> Values:
    """Compute Planck's constant h for which a given length is the thermal wavelength."""
    return length * np.sqrt(2.0 * np.pi * mass * np.asarray(temperature, dtype=float))


def scaled_particle_activity(eta: Values) -> Values:
    """Compute the activity of hard discs by scaled-particle theory."""
    return eta / (1.0 - eta) * np.exp((3.0 * eta - 2.0 * eta**2) / (1.0 - eta) ** 2)


def layer_diameter(width: float) -> float:
    """Compute the diameter of the hard discs that represent spheres of diameter 1 in a layer."""
    return float(np.sqrt(1.0 - width**2 / 6.0))


def excluded_in_front(packing_fraction: float, width: float) -> float:
    """Compute the volume in front of a layer that one more sphere in it, of diameter 1, closes to the gas."""
    eta = float(checked_packing_fraction(packing_fraction, STABLE_DISCS))
    nodes, weights = np.polynomial.legendre.leggauss(32)
    total = 0.0
    for low, high in ((0.5 * width, _EXACT), (_EXACT, 1.0)):
        height = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        radius = np.sqrt(1.0 - height**2)
        closed = 4.0 * radius**2
        if low < _EXACT:
            x, free = 2.0 * radius - 1.0, 1.0 - eta
            work = -np.log(free) + 2.0 * eta * x / free + eta * x**2 / free**2
            slope = 1.0 / free + 2.0 * x / free**2 + (1.0 + eta) * x**2 / free**3
            closed = np.exp(-work) * slope
        total += 0.5 * (high - low) * float(weights @ closed)
    return 0.25 * np.pi * total


def layer_activity(activity: float, packing_fraction: float, gas_density: float, width: float) -> float:
    """Compute the activity of the hard discs that represent spheres in a well."""
    gained = 2.0 * np.pi / 3.0 - excluded_in_front(packing_fraction, width)
    return float(activity * layer_diameter(width) ** 2 * np.exp(gas_density * gained))


def excess_of_few(activity: float, held: float, others: float) -> float:
    """Compute the relative excess of discs in a layer next to a small gas."""
    step = 0.05
    lower, middle, upper = np.log(
        packing_fraction_at(activity * np.exp(step * np.array([-1.0, 0.0, 1.0])), 2)
    )
    slope, bend = (upper - lower) / (2.0 * step), (upper - 2.0 * middle + lower) / step**2
    return float((slope * (1.0 - slope) - bend) / (2.0 * (others + slope * held)))


def flux_density(speed: Values) -> Values:
    """Compute the probability density of the normal speeds of particles that leave a wall."""
    return speed * np.exp(-0.5 * speed**2)


def slow_flux_share(speed: Numbers) -> Values:
    """Compute the fraction of particles that leave a wall with less than a normal speed."""
    return -np.expm1(-0.5 * np.asarray(speed, dtype=float) ** 2)


class Wall:
    """Adsorbing wall and its gas; `held`, `free`, `far`: mean numbers in the well, outside, far off."""

    def __init__(self, point: Point) -> None:
        scene, gas = point.scene, point.scene.species[0]
        face: Any = scene.faces["x_low"]
        self.mass, self.sigma = gas.mass, 2.0 * gas.radius
        self.temperature = thermal_face(scene, "x_high").temperatures[0]
        self.is_well: bool = isinstance(face, Well)
        well: tuple[float, float] = (face.depth, face.width) if self.is_well else (0.0, 0.0)
        self.depth, self.width = well
        self.kind = ("layer" if self.width < gas.radius else "ideal") if self.is_well else "sticky"
        self.area = scene.container.lengths[1] * scene.container.lengths[2]
        self.outside = scene.reach(gas.radius)[1][0] - gas.radius - self.width
        self.thermal_speed = np.sqrt(self.temperature / gas.mass)
        self.slow = 1.0 if self.is_well else face.momentum / (gas.mass * self.thermal_speed)
        self._hold = self.width * np.exp(self.depth / self.temperature) * particle_volume(2, self.sigma)

    def density(self, far: float) -> float:
        """Density of the gas, at least a diameter from walls and well."""
        return far / ((self.outside - 2.0 * self.sigma) * self.area)

    def coverage(self, held: float) -> float:
        """Fraction of the wall's area that particles cover."""
        return held * particle_volume(2, self.sigma) / self.area

    def activity(self, far: float) -> float:
        """Coverage of a layer without interaction, beta P w e^(depth/kT) pi sigma^2 / 4."""
        n = self.density(far)
        return n * compressibility_factor(n * particle_volume(3, self.sigma), 3) * self._hold

    def fugacity(self, far: float) -> float:
        """The same with the activity of the gas in place of its pressure."""
        n = self.density(far)
        return n * np.exp(excess_chemical_potential(n * particle_volume(3, self.sigma), 3)) * self._hold

    def ideal_ratio(self, held: float, free: float) -> float:
        """Return held / free without what spheres close to each other."""
        densities = held / (self.width * self.area), free / (self.outside * self.area)
        return held / free * np.exp(-excess_in_well(*densities, self.sigma, self.width, self.outside))

    def filling(self, held: float, free: float, far: float) -> float:
        """Coverage divided by that of hard discs in equilibrium with the gas."""
        width = self.width / self.sigma
        discs = self.coverage(held) * layer_diameter(width) ** 2
        activity = layer_activity(self.activity(far), discs, self.density(far) * self.sigma**3, width)
        few = 1.0 + excess_of_few(activity, held, free)
        return discs / float(packing_fraction_at(activity, 2)) / few


def counts(wall: Wall, height: np.ndarray, velocity: np.ndarray, settings: dict) -> tuple:
    """Return means over a block: held, free and far particles; slow flux, and flux by speed. Heights (T, N)
    are those of centres above the lowest position; velocities are along x.
    """
    held, above = height < wall.width if wall.is_well else velocity == 0.0, height - wall.width
    far = (above > wall.sigma) & (above < wall.outside - wall.sigma)
    speed = velocity[~held & (above < settings["near"]) & (velocity > 0.0)] / wall.thermal_speed
    grid = _speeds(settings)
    flux = grid.sums(grid.cells(speed[:, None]), speed)  # a particle stays near for a time as 1 / speed
    parts = held.sum(), (~held).sum(), far.sum(), speed[speed < wall.slow].sum(), flux
    return tuple(part / len(height) for part in parts)


def _speeds(settings: dict) -> Grid:
    return Grid.line(0.0, 4.0, settings["bins"])


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure each wall: particles held, coverage, density of the gas, and flux of leaving particles."""
    dataset = table("point", points, _measure_wall, settings, inner=("bin",))
    return dataset.assign_coords(speed=("bin", _speeds(settings).middles[0])).set_coords("experiment")


def _measure_wall(point: Point, settings: dict) -> dict:
    wall = Wall(point)
    number = settings["layer_blocks"] if wall.kind == "layer" else settings["blocks"]
    radius = 0.5 * wall.sigma
    each = Blocks(
        counts(wall, height - radius, velocity, settings)
        for run in runs(point)
        for height, velocity in run_blocks(run, number)
    )
    facts = ("kind", "temperature", "depth", "width", "mass", "outside")
    row = {name: getattr(wall, name) for name in facts}
    row |= {"experiment": point.experiment, "slow_speed": wall.slow}
    row["held"] = each(lambda held, *_: held)
    row["ratio"] = each(lambda held, free, *_: held / free)
    row["coverage"] = each(lambda held, *_: wall.coverage(held))
    row["gas_density"] = each(lambda held, free, far, *_: wall.density(far))
    if wall.kind == "ideal":
        depth = wall.depth / wall.temperature
        row["log_ratio"] = each(lambda held, free, *_: np.log(wall.ideal_ratio(held, free)))
        row["length"] = each(lambda *n: wall.ideal_ratio(*n[:2]) * wall.outside * np.exp(-depth))
    if wall.kind == "layer":
        row["activity"] = each(lambda held, free, far, *_: wall.activity(far))
        row["filling"] = each(lambda held, free, far, *_: wall.filling(held, free, far))
        row["filling_by_activity"] = each(
            lambda held, free, far, *_: wall.coverage(held) / packing_fraction_at(wall.fugacity(far), 2)
        )
    else:  # hardly any particle leaves a layer
        row["flux"] = each(lambda *means: means[4] / (means[4].sum() * _speeds(settings).volume))
        row["slow_share"] = each(lambda *means: means[3] / means[4].sum())
    return row


def run_blocks(run: Run, number: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield positions and velocities (T, N) along x of each block of a run."""
    run.block_length(number)
    names = ("coordinates", "velocities")
    series = (run.data[name][1:, :, 0].values.astype(float) for name in names)
    return zip(*(np.array_split(values, number) for values in series), strict=True)


OWN_LENGTH = (
    "equilibrium of an ideal gas with a step well: the length is its width (exact); what spheres close to "
    "each other is subtracted, to first order in their density"
)
LANGMUIR = (
    "Boltzmann factor of the well (exact for an ideal gas; Langmuir's formula, [source A], section 4.5); "
    "what spheres close to each other is subtracted, to first order in their density"
)
DISCS = (
    "spheres in a layer thinner than their diameter, as hard discs (virial series to B10), at the "
    "density P/kT that a hard wall has at contact (exact where the coverage is low), and to first order "
    "in the gas' density what the layer closes to it (scaled-particle theory), and in 1/N what a gas of "
    "N loses to the layer"
)


def claims(dataset: xr.Dataset) -> Iterator[Any]:
    """Yield claims on slope and prefactor of wells, on layers, and on detailed balance."""
    ideal, layer, sticky = _by_kind(dataset)
    for width, same in ideal.by("width"):
        yield Claim(
            f"length in place of the thermal wavelength over the well's width, width {width:g}",
            combine_estimates(same.length) / width, 1.0, 0.01, OWN_LENGTH,
            "an additional prefactor: particles enter or leave against the Boltzmann factor",
        )  # fmt: skip
        for depth, well in same.by("depth"):
            if len(well) < 2:
                continue
            yield Claim(
                f"slope of ln(N_ads/N_gas) against 1/kT over the depth, depth {depth:g}",
                fit_polynomial(1.0 / well.temperature, well.log_ratio).estimate(1) / depth,
                1.0, 0.005, LANGMUIR,
                "particles leave the well with less, or more, than its depth",
            )  # fmt: skip
            planck = planck_constant(1.0, well.mass, well.temperature) * well.length
            yield Claim(
                f"power of T in h = lambda sqrt(2 pi m k T), lambda that length, depth {depth:g}",
                fit_power_law(well.temperature, planck).estimate, 0.5, 0.02,
                f"{OWN_LENGTH}; Planck's constant would be constant, the power 0",
                "a length that depends on T: a thermal wavelength, and so Planck's constant, at -1/2",
            )  # fmt: skip
    subject = "coverage over that of hard discs at the gas' pressure"
    for wall in layer:  # only the lowest coverage tells pressure from activity
        by_activity = wall.filling.value / wall.filling_by_activity.value
        yield Claim(
            f"{subject}, depth {wall.depth:g}", wall.filling, 1.0, 0.04, DISCS,
            "adsorbed spheres do not collide with each other, or each has a site of its own; or the "
            "gas' activity takes the place of its pressure",
            alternative=by_activity if wall.depth == layer.depth.min() else None,
        )  # fmt: skip
    if layer:
        yield Claim(
            f"{subject}, mean of all depths", combine_estimates(layer.filling), 1.0, 0.005, DISCS,
            "adsorbed spheres close as much of the gas' room as single ones, or a part of it twice",
        )  # fmt: skip
        yield Claim.joint(
            f"{subject}, all depths", (layer.filling - 1.0).deviation, DISCS,
            "uncertainties too small, as from time blocks that are not independent",
        )  # fmt: skip
    yield Claim.at_most(
        "sticky rule: power of the gas' density in the coverage of a wall at low coverage",
        fit_power_law(sticky.gas_density.value, sticky.coverage).estimate, 0.2, 0.1,
        "the gas both brings and frees particles, both as its density; Henry's law requires 1",
        "a coverage that is proportional to the pressure, as under detailed balance",
    )  # fmt: skip
    slow = float(slow_flux_share(sticky.slow_speed[0]))
    yield Claim.at_most(
        "sticky rule: slow particles that leave the wall, over those that would in equilibrium",
        combine_estimates(sticky.slow_share) / slow, 0.5, 0.1,
        "slow particles stick, and none is sent back so slowly: only those slowed down when freed remain",
        "a wall that sends back as many slow particles as it takes",
    )  # fmt: skip
    yield Claim(
        "wells: share of the particles that leave below sqrt(kT/m)",
        combine_estimates(ideal.slow_share), slow_flux_share(1.0), 0.005,
        "flux of a Maxwellian, 1 - e^(-1/2) (exact)", "a well that selects particles by their speed",
    )  # fmt: skip


def _by_kind(dataset: xr.Dataset) -> list[Table]:
    walls = Table(dataset, "point")
    return [walls[walls.kind == kind] for kind in KINDS]


def draw(dataset: xr.Dataset) -> Figure:
    """Draw ratio and prefactor of ideal gases, isotherms, and speeds of leaving particles."""
    figure, axes = style.new((2.2, 1.1), (1.7,), (2.0,), (1.4,), (1.9,))
    ideal, layer, sticky = _by_kind(dataset)
    _wells(axes[0], axes[1], axes[2], ideal)
    _coverage(axes[3], axes[4], layer, sticky)
    _leaving(axes[5], dataset.speed.values, ideal[0], sticky[np.argmax(sticky.gas_density.value)])
    titles = "(a) wells", "(b) wells", "(c) thin well", "(d) sticky wall", "(e) well and sticky wall"
    for axis, title in zip((axes[0], *axes[2:]), titles, strict=True):
        style.letter(axis, title)
    return figure


def _wells(ratio: Axes, below: Axes, length: Axes, wells: Table) -> None:
    inverse = np.linspace(0.0, 1.05 / wells.temperature.min(), 50)
    style.level(below, 0.0)
    for kind, (depth, width, well) in enumerate(wells.by("depth", "width")):
        x, of = 1.0 / well.temperature, (width, well.outside[0])
        look: dict[str, Any] = {"kind": kind, "hollow": True}
        style.points(ratio, x, well.ratio, label=f"$\\epsilon$ = {depth:g}, $w$ = {width:g}", **look)
        ratio.plot(inverse, well_ratio(depth * inverse, *of), color=style.COLOURS[kind], lw=0.8)
        deviation = well.log_ratio - np.log(well_ratio(depth * x, *of))
        style.points(below, x + 0.02 * (kind - 1), 100.0 * deviation, **look)
        style.points(length, well.temperature, well.length / width, **look)
    style.label_axes(ratio, y=r"$N_\mathrm{ads}/N_\mathrm{gas}$", legend="upper left", yscale="log")
    labels = r"inverse temperature $1/kT$", "deviation from\nexact (%)"
    style.label_axes(below, *labels, xlim=(0.0, inverse[-1]))
    warm = np.geomspace(0.8 * wells.temperature.min(), 1.25 * wells.temperature.max(), 50)
    length.plot(warm, warm**-0.5, color=style.DATA, ls=":", label="thermal wavelength")
    length.axhline(1.0, color=style.REFERENCE, label="width of the well")
    _log_ticks(length, 0.5, 1.0, 2.0)
    style.label_axes(length, r"temperature $kT$", r"length $\lambda/w$", "upper right")


def _coverage(isotherm: Axes, amount: Axes, layer: Table, sticky: Table) -> None:
    eta, activity = np.linspace(1e-3, 0.52, 300), np.geomspace(0.01, 100.0, 200)
    grey: dict[str, Any] = {"color": style.GREY}
    isotherm.plot(scaled_particle_activity(eta), eta, color=style.REFERENCE, label="hard discs (SPT)")
    isotherm.plot(activity, activity, ls=":", label="Henry (ideal gas)", **grey)
    isotherm.plot(activity, activity / (1.0 + activity), ls="--", label="Langmuir (sites)", **grey)
    spheres = layer.activity, layer.coverage
    style.points(isotherm, *spheres, color=style.DATA, hollow=True, zorder=4, label="spheres")
    labels = r"$(P/kT)\, w\, e^{\epsilon/kT}\, \pi\sigma^2/4$", r"coverage $\eta$", "lower right"
    style.label_axes(isotherm, *labels, xscale="log", xlim=(0.02, 60.0), ylim=(0.0, 0.6))
    density, middle = sticky.gas_density.value, len(sticky) // 2
    line = np.geomspace(0.8 * density.min(), 1.25 * density.max(), 50)
    style.points(amount, density, sticky.coverage, kind=1, label="sticky wall")
    henry = sticky.coverage.value[middle] * line / density[middle]
    amount.plot(line, henry, ls="--", label="Henry (equilibrium)", **grey)
    amount.set_yscale("log")
    _log_ticks(amount, 0.01, 0.02, 0.05)
    labels = r"density of the gas $\rho\sigma^3$", r"coverage $\eta$", "lower right"
    style.label_axes(amount, *labels, xlim=(line[0], line[-1]))


def _leaving(axis: Axes, speed: np.ndarray, well: Row, sticky: Row) -> None:
    line = np.linspace(0.0, speed[-1], 200)
    axis.plot(line, flux_density(line), color=style.REFERENCE, label=r"$v\,e^{-v^2/2}$")
    for row, kind, name in ((well, 0, "well"), (sticky, 1, "sticky wall")):
        style.points(axis, speed, row.flux, kind=kind, hollow=not kind, label=name)
    axis.axvline(sticky.slow_speed, color=style.GREY, ls=":")
    labels = r"normal speed $v\sqrt{m/kT}$", "probability density", "upper right"
    style.label_axes(axis, *labels, ylim=(0.0, None))


def _log_ticks(axis: Axes, *values: float) -> None:
    axis.set_xscale("log")
    axis.set_xticks(values, [f"{value:g}" for value in values])
    axis.minorticks_off()


FIGURES = {"adsorption": Parts(SETTINGS, measure, claims, draw, key=5)}
