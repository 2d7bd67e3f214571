"""A large disc under gravity in a fluid of small discs: its force, or its height.

The force on a fixed disc is the missing term in the momentum balance of the fluid: floor - ceiling - weight -
gain of momentum. It is exact over any time. The large disc is the scene's first particle. The small discs are
the only species; masses are in units of theirs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.flow import Grid
from gaspart.analysis.statistics import combine_estimates, fit_polynomial, mean_of
from gaspart.keys import count, names, positive
from gaspart.rendering import style
from gaspart.rendering.style import Axes, Figure
from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.figure import Blocks, Parts
from gaspart.reproduction.figures._columns import Field, Stretch, field, stretches
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import Row, Table, merge_with_prefixes, table
from gaspart.theory.brownian import displaced_area
from gaspart.theory.geometry import particle_volume
from gaspart.theory.gravity import hydrostatic_profiles
from gaspart.theory.tables import excess_chemical_potential, packing_fraction_at

TITLE, CHAPTER = "Under gravity", "Gravity, heat and walls"
SETTINGS = {
    "source": names("the experiments of source C's own fluid"),
    "bins": count("bins of height"),
    "blocks": count("stretches of each replica"),
    "clear": positive("small diameters next to floor and ceiling that are left out, where layers are"),
    "far": positive(
        "small diameters across from the large disc's edge beyond which the fluid is undisturbed"
    ),
    "near": positive("small diameters around that edge within which missing small discs are counted"),
    "source_density": positive("at which source C expects its large disc to float in the middle"),
}
KINDS = ("fixed", "free", "source")


def measure(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure forces on fixed discs, and heights of free ones, the source's apart; and the displaced mass."""
    of_source = [point for point in points if point.experiment in settings["source"]]
    own = [point for point in points if point not in of_source]
    held = [point for point in own if point.scene.particles[0].fixed]
    moving = [point for point in own if point not in held]
    of_source.sort(key=lambda point: point.scene.particles[0].mass)
    fixed = table("fixed", held, _measure_fixed, settings, inner=("place",))
    column, ratio = field(held[0]), float(fixed["size_ratio"][0])
    dataset = merge_with_prefixes(
        fixed=fixed.drop_vars("fluid"),
        free=table("free", moving, _measure_free, settings),
        source=table("source", of_source, _measure_free, settings),
    )
    eta = fixed["fluid"].values.mean(axis=0)
    dataset = dataset.assign(displaced=("height", eta * displaced_area(eta, ratio)), height=_heights(column))
    return dataset.assign_attrs(
        size_ratio=ratio,
        strength=column.strength,
        top=column.height,
        source_density=settings["source_density"],
    )


def _heights(column: Field) -> np.ndarray:
    return np.linspace(0.0, column.height, 201)


class Disc:
    """Large disc of a point, and the fluid around it; `density` (blocks, B) is that far from the disc."""

    def __init__(self, point: Point, settings: dict) -> None:
        particle = point.scene.particles[0]
        self.column, self.blocks = field(point), stretches(point, settings["blocks"])
        self.radius, self.mass, self.diameter = particle.radius, particle.mass, self.column.diameter
        self.ratio = 2.0 * self.radius / self.diameter
        self.height = particle.position[1] - 0.5 * self.diameter
        self.temperature = float(np.mean([stretch.temperature for stretch in self.blocks]))
        self.grid = Grid.line(0.0, self.column.height, settings["bins"])
        away = self.radius + settings["far"] * self.diameter
        self.density = np.array([self._far(stretch, away) for stretch in self.blocks])
        self.fluid = self._hydrostatics(settings["clear"])

    def _across(self, stretch: Stretch, others: slice) -> np.ndarray:
        across = np.abs(stretch.positions[:, others, 0] - stretch.positions[:, :1, 0])
        return np.minimum(across, self.column.width - across)

    def _far(self, stretch: Stretch, away: float) -> np.ndarray:
        far = self._across(stretch, slice(None)) > away
        counts = self.grid.sums(self.grid.cells(stretch.heights[far][:, None]))
        return counts / (len(stretch.heights) * (self.column.width - 2.0 * away) * self.grid.volume)

    def _hydrostatics(self, clear: float) -> Callable[[np.ndarray], Any]:
        """Return the packing fraction by height of a fluid of as many discs, without layers at the floor."""
        density = self.density.mean(axis=0)
        width = self.column.height / len(density)
        skip = int(np.ceil(clear * self.diameter / width))
        z = np.linspace(skip * width, (len(density) - skip) * width, 1001)
        weight = self.column.masses[-1] * self.column.strength / self.temperature
        number = density[skip : len(density) - skip].sum() * width
        lowest = hydrostatic_profiles(z, [number], [weight], 2, self.diameter)[0, 0]
        eta = lowest * particle_volume(2, self.diameter)
        logarithm = np.log(eta) + excess_chemical_potential(eta, 2) + weight * z[0]
        return lambda height: packing_fraction_at(np.exp(logarithm - weight * height), 2)

    def inside(self, stretch: Stretch, reach: float) -> float:
        """Return the mean number of small discs within `reach` of the centre."""
        square = self._across(stretch, slice(1, None)) ** 2 + (stretch.heights[:, 1:] - self.height) ** 2
        return float((square < reach**2).sum(axis=1).mean())


def _measure_fixed(point: Point, settings: dict) -> dict[str, Any]:
    """Measure force and missing discs; the radius of a disc of fluid with that mass, beyond the disc's own.
    The force is the weight of such a disc. Radii are in small radii.
    """
    disc = Disc(point, settings)
    column, ratio, volume = disc.column, disc.ratio, particle_volume(2, disc.diameter)
    force = np.array([s.floor - s.ceiling - column.weight - s.gain for s in disc.blocks])
    displaced = force / (column.masses[-1] * column.strength)
    # One smooth profile serves for all blocks, scaled to the number of discs in each block: missing discs are
    # counted relative to it. It is integrated over strips of a disc.
    reach = disc.radius + settings["near"] * disc.diameter
    up = reach * ((np.arange(400) + 0.5) * 2.0 / 400 - 1.0)
    strips = 2.0 * np.sqrt(reach**2 - up**2) * 2.0 * reach / 400
    undisturbed = float((disc.fluid(disc.height + up) * strips).sum() / volume)
    inside = np.array([disc.inside(stretch, reach) for stretch in disc.blocks])
    missing = undisturbed * disc.density.sum(axis=1) / disc.density.mean(axis=0).sum() - inside
    # Undisturbed density at the disc's position, averaged over the area of the disc.
    [z] = disc.grid.middles
    chord = np.sqrt(np.maximum(disc.radius**2 - (z - disc.height) ** 2, 0.0))
    there = disc.density @ (chord / chord.sum())
    each = Blocks(zip(displaced, missing, there, strict=True))

    def beyond(number: float, density: float) -> float:
        return float(np.sqrt(number / (np.pi * density))) / (0.5 * disc.diameter) - ratio

    packing_fraction = mean_of(there * volume)
    return {
        "force": mean_of(displaced),
        "missing": mean_of(missing),
        "packing_fraction": packing_fraction,
        "force_radius": each(lambda displaced, missing, there: beyond(displaced, there)),
        "count_radius": each(lambda displaced, missing, there: beyond(missing, there)),
        "radius_expected": float(np.sqrt(displaced_area(packing_fraction.value, ratio)) - ratio),
        "height": disc.height,
        "size_ratio": ratio,
        "fluid": disc.fluid(_heights(column)),
    }


def _measure_free(point: Point, settings: dict) -> dict[str, Any]:
    """Measure the height of a free disc; compute it by Boltzmann's factor of its weight less the fluid's."""
    disc = Disc(point, settings)
    column, margin = disc.column, disc.radius - 0.5 * disc.diameter
    z = np.linspace(margin, column.height - margin, 2001)
    # Forces are integrated, instead of differences of work. The largest term, from the pressure of the fluid,
    # is then exact. Only the term from the edge relies on scaled-particle theory.
    eta = disc.fluid(z)
    force = column.masses[-1] * eta * displaced_area(eta, disc.ratio) - disc.mass
    exponent = np.cumsum(force) * (z[1] - z[0]) * column.strength / disc.temperature
    chance = np.exp(exponent - exponent.max())
    chance /= chance.sum()
    expected = chance @ z
    heights = [stretch.heights[:, 0] for stretch in disc.blocks]
    each = Blocks((height.mean(), (height**2).mean()) for height in heights)
    spread = each(lambda mean, square: math.sqrt(max(square - mean**2, 0.0)))
    return {
        "mass": disc.mass / column.masses[-1],
        "height": mean_of([height.mean() for height in heights]),
        "spread": (spread.value, spread.error),
        "expected": expected,
        "expected_spread": np.sqrt(chance @ (z - expected) ** 2),
        "lowest": margin,
        "highest": column.height - margin,
        "density": disc.mass / (np.pi * disc.radius**2),
    }


THEORY = "scaled-particle theory ([Helfand 1961])"
AFLOAT, LYING = 3.0, 1.8
"""Expected distances from floor and ceiling, in the source's unit of length (a small disc has 1.6). A disc of
the source floats if its distance is above AFLOAT. It lies at the floor or ceiling below LYING. In between,
layers of small discs matter, for which there is no theory."""
_NEAREST = 4  # discs around the middle, for the linear fit of the height against the density


def claims(dataset: xr.Dataset) -> Iterator[Claim]:
    """Yield claims on Archimedes's principle, the displaced radius, and heights of discs."""
    fixed, free, source = (Table.from_prefixed(dataset, kind) for kind in KINDS)
    yield from _claim_fixed(fixed)
    largest = Table(dataset, "height").displaced.max()
    for disc in free:
        if disc.mass <= largest:
            yield _floating(disc, "a free disc")
        else:
            yield Claim.at_most(
                f"mean height above the floor of a free disc of mass {disc.mass:g}, which displaces less",
                disc.height - disc.lowest, 2.0, 0.5,
                "its weight beyond the displaced one holds it down: kT/(Mg - F)",
                "a disc that is heavier than the fluid it displaces and does not sink",
            )  # fmt: skip
    if source:
        yield from _claim_source(source)


def _claim_fixed(discs: Table) -> Iterator[Claim]:
    def nearer(radius: float) -> float:  # 0 or 1: R or R + r
        return 0.0 if radius < 0.5 else 1.0

    for disc in discs:
        yield Claim(
            f"radius displaced beyond the disc's own, in small radii, by the small discs missing, "
            f"height {disc.height:g}",
            disc.count_radius, disc.radius_expected, 0.15, THEORY,
            "a fluid that does not accumulate at the disc's edge as theory states",
            alternative=nearer(disc.radius_expected),
        )  # fmt: skip
    yield Claim(
        "force on fixed discs over the weight of the small discs missing, all heights",
        combine_estimates(discs.force / discs.missing), 1.0, 0.04,
        "Archimedes: F = m g dW/dmu, the slope of the work of insertion (exact far from floor and ceiling)",
        "a force that is not the weight of the displaced fluid",
    )  # fmt: skip
    of_all = discs.force_radius.weights @ discs.radius_expected
    yield Claim(
        "radius displaced beyond the disc's own, in small radii, by the force, all heights",
        combine_estimates(discs.force_radius), of_all, 0.1, THEORY,
        "R (0) or R + r (1) alone as the radius that counts in a dense fluid", alternative=nearer(of_all),
    )  # fmt: skip


def _floating(disc: Row, name: str) -> Claim:
    return Claim(
        f"mean height of {name} of mass {disc.mass:g}", disc.height, disc.expected, 2.0,
        f"Boltzmann's factor of its weight less the displaced one's, {THEORY}",
        "a disc that does not float where it displaces its own mass",
    )  # fmt: skip


def _claim_source(discs: Table) -> Iterator[Claim]:
    """Yield claims on which of the source's discs float, where, and on the density of one in the middle."""
    near = np.minimum(discs.expected - discs.lowest, discs.highest - discs.expected)
    middle = 0.5 * (discs.lowest[0] + discs.highest[0])
    afloat, lying = discs[near > AFLOAT], discs[near < LYING]
    for disc in afloat:
        yield _floating(disc, "the source's disc")
    is_heavy = lying.expected < middle
    heavy, light = lying[is_heavy], lying[~is_heavy]
    if heavy:
        yield _lying(heavy.height - heavy.lowest, "heavier discs above the floor")
    if light:
        yield _lying(light.highest - light.height, "lighter discs below the ceiling")
    if len(afloat) >= _NEAREST:
        nearest = afloat[np.argsort(abs(afloat.height.value - middle))[:_NEAREST]]
        density, height = nearest.density, nearest.height - middle
        offset, slope = fit_polynomial(density, height).values
        neutral = -offset / slope
        # The line is fitted again around that density, where the error of the height matters.
        there = fit_polynomial(density - neutral, height).estimate(0)
        yield Claim(
            "density at which a disc floats in the middle over the source's estimate",
            (-there / slope + neutral) / nearest.source_density, 1.0, 0.02,
            "notebook of [source C]'s code (tms-ninja/billiards), buoyancy: mean density of small discs",
            "a disc that displaces exactly its own area of the fluid", kind="reproduction",
            source_error="a disc displaces the fluid of a larger radius than its own, as the claims above "
            "state",
        )  # fmt: skip


def _lying(distance: Estimate, which: str) -> Claim:
    farthest = distance[np.argmax(distance.value)]
    return Claim.at_most(
        f"largest mean distance of {len(distance)} of the source's {which}",
        Estimate(farthest.value, farthest.error), AFLOAT, 0.5,
        "held there by the weight less the displaced one (kT/|Mg - F|), or by a layer of discs",
        "discs that displace less (more) than their mass at all heights, and float",
    )  # fmt: skip


def draw(dataset: xr.Dataset) -> Figure:
    """Draw the force against density, the displaced radius, and the heights of free discs."""
    fixed, free, source = (Table.from_prefixed(dataset, kind) for kind in KINDS)
    figure, axes = style.new((2.1, 2.1), (2.1,), *([(2.1,)] if source else []))
    _draw_displacement(axes[0], axes[1], fixed, dataset.attrs["size_ratio"])
    _draw_heights(axes[2], free, Table(dataset, "height"))
    if source:  # from the floor to the ceiling
        density, axis = source.density / source.source_density, axes[3]
        for end in (source.lowest[0], source.highest[0]):
            style.level(axis, end, ls=":")
        axis.plot(density, source.expected, color=style.DATA, label="theory", zorder=2)
        style.points(axis, density, source.height, label="source's discs")
        axis.axvline(1.0, color=style.GREY, ls="--", lw=0.8, zorder=1)
        labels = "density of the disc / mean of the fluid", "height $z$ (length)"
        style.label_axes(axis, *labels, legend="upper right")
    style.letters(*axes)
    return figure


def _draw_displacement(top: Axes, middle: Axes, discs: Table, ratio: float) -> None:
    packing = discs.packing_fraction.value
    eta = np.linspace(0.0, 1.1 * packing.max(), 200)
    for area, label, dashes in (
        (np.full_like(eta, ratio**2), "radius $R$", ":"),
        (np.full_like(eta, (ratio + 1.0) ** 2), "radius $R+r$", "--"),
        (displaced_area(eta, ratio), "scaled-particle theory", "-"),
    ):
        colour = style.DATA if dashes == "-" else style.GREY
        top.plot(eta, area * eta, ls=dashes, color=colour, label=label, zorder=2)
        middle.plot(eta, np.sqrt(area) - ratio, ls=dashes, color=colour, zorder=2)
    style.points(top, packing, discs.force, label="from the force")
    style.points(top, packing, discs.missing, kind=1, hollow=True, label="missing small discs")
    style.points(middle, packing, discs.force_radius)
    style.points(middle, packing, discs.count_radius, kind=1, hollow=True)
    style.label_axes(top, y=r"displaced mass $F/mg$", legend="upper left")
    labels = r"packing fraction $\eta$ of the fluid at that height", r"$(R_\mathrm{eff} - R)/r$"
    style.label_axes(middle, *labels, ylim=(-0.15, 1.35))


def _draw_heights(axis: Axes, discs: Table, fluid: Table) -> None:
    axis.plot(fluid.displaced, fluid.height, color=style.DATA, label=r"displaced mass $M$", zorder=2)
    for disc in discs:
        label = "standard deviation" if disc.mass == discs.mass[0] else None
        ends = [disc.height.value - disc.spread.value, disc.height.value + disc.spread.value]
        axis.plot([disc.mass] * 2, ends, color=style.COLOURS[0], lw=5, alpha=0.25, label=label, zorder=1)
    style.points(axis, discs.mass, discs.height, label="mean height")
    style.points(axis, discs.mass, discs.expected, kind=1, label="theory", marker="_", markersize=11)
    labels = "mass $M/m$ of a free disc", "height $z$ (length)"
    style.label_axes(axis, *labels, legend="upper right", ylim=(0.0, discs.top))
    axis.set_xlim(0.0, 1.08 * discs.mass.max())


FIGURES = {"buoyancy": Parts(SETTINGS, measure, claims, draw)}
