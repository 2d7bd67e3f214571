"""Adsorption on a wall: the amount, the coverage, and the speeds of desorption.

The adsorbing wall is the face x_low; it has a potential well or is sticky. The opposite face is a thermal
wall. Each replica is cut into `blocks`, which are assumed independent. Errors are jackknife errors over these
blocks.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gaspart.analysis.flow import Grid
from gaspart.analysis.run import Run
from gaspart.analysis.statistics import jackknife
from gaspart.reproduction.families.shared.runs import runs
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import entries, table
from gaspart.scene.faces import Sticky, Well, thermal_face
from gaspart.theory.adsorption import (
    excess_in_well,
    excess_of_few,
    layer_activity,
    layer_diameter,
    length_in_langmuirs_formula,
)
from gaspart.theory.geometry import particle_volume
from gaspart.theory.state import compressibility_factor
from gaspart.theory.tables import excess_chemical_potential, packing_fraction_at

_REACH = 4.0  # bins of the histogram of speeds, in units of sqrt(kT/m)


@dataclass(frozen=True)
class Holder:
    """Adsorbing wall, and the gas next to it; lengths are in the scene's units.

    kind : "ideal" (the gas is dilute even in the well), "layer" (the well is narrower than a particle) or
    "sticky".
    depth, width : depth and width of the well; 0 if there is no well.
    momentum : momentum below which particles stick; 0 if they do not stick.
    outside : length along x that is accessible to the centres of gas particles.
    """

    kind: str
    temperature: float
    depth: float
    width: float
    momentum: float
    mass: float
    radius: float
    area: float
    outside: float

    @classmethod
    def of(cls, point: Point) -> Holder:
        """Return the adsorbing wall of a point with one species in three dimensions.

        The gas is between x_low and a thermal x_high.
        """
        scene = point.scene
        face, species = scene.faces["x_low"], scene.species[0]
        low, high = (ends[0] for ends in scene.reach(species.radius))
        kind, depth, width, momentum = "sticky", 0.0, 0.0, 0.0
        match face:
            case Well(depth, width):
                kind = "layer" if width < species.radius else "ideal"
            case Sticky(momentum):
                pass
        return cls(
            kind=kind,
            temperature=thermal_face(scene, "x_high").temperatures[0],
            depth=depth,
            width=width,
            momentum=momentum,
            mass=species.mass,
            radius=species.radius,
            area=scene.container.lengths[1] * scene.container.lengths[2],
            outside=high - low - width,
        )

    def holds(self, height: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Return True for particles in the well, or stuck to the wall.

        Only stuck particles have zero velocity along x. Heights are measured from particle centres to the
        lowest position. Heights and velocities along x have the same, arbitrary shape.
        """
        return height < self.width if self.kind != "sticky" else velocity == 0.0

    def coverage(self, count: float | np.ndarray) -> float | np.ndarray:
        """Compute the fraction of the wall's area that `count` particles cover."""
        return count * particle_volume(2, 2.0 * self.radius) / self.area

    def gas_density(self, count: np.ndarray) -> np.ndarray:
        """Compute the density of `count` particles, at least a diameter from walls and well."""
        return count / ((self.outside - 4.0 * self.radius) * self.area)

    def activity(self, density: float | np.ndarray) -> float | np.ndarray:
        """Compute the coverage of a layer of particles without interaction, at the pressure of the gas.

        The coverage is the packing fraction beta P w e^{depth/kT} pi sigma^2 / 4; it is 0 if there is no
        well.
        """
        eta = density * particle_volume(3, 2.0 * self.radius)
        pressure = density * compressibility_factor(eta, 3)
        return pressure * self._hold

    def ideal_ratio(self, held: np.ndarray, others: np.ndarray) -> np.ndarray:
        """Compute the ideal-gas ratio of the particles in the well to all other particles."""
        densities = held / (self.width * self.area), others / (self.outside * self.area)
        excess = excess_in_well(*densities, 2.0 * self.radius, self.width, self.outside)
        return held / others * np.exp(-excess)

    def filling(self, held: float, density: float, others: float) -> float:
        """Compute the coverage of a layer divided by the coverage of hard discs in equilibrium.

        The layer has `held` particles. The gas in equilibrium with the discs has the given density and
        `others` particles.
        """
        diameter, coverage = 2.0 * self.radius, float(self.coverage(held))
        width = self.width / diameter
        discs = coverage * float(layer_diameter(width)) ** 2
        activity = float(layer_activity(self.activity(density), discs, density * diameter**3, width))
        return discs / float(packing_fraction_at(activity, 2)) / (1.0 + excess_of_few(activity, held, others))

    @property
    def _hold(self) -> float:
        return self.width * np.exp(self.depth / self.temperature) * particle_volume(2, 2.0 * self.radius)

    def fugacity(self, density: float | np.ndarray) -> float | np.ndarray:
        """Compute `activity` with the activity of the gas instead of its pressure.

        The activity of the gas is rho exp(mu_excess / kT). This would be exact if the gas in front of the
        layer did not affect the layer.
        """
        eta = density * particle_volume(3, 2.0 * self.radius)
        return density * np.exp(excess_chemical_potential(eta, 3)) * self._hold


def adsorption(points: list[Point], settings: dict) -> xr.Dataset:
    """Measure adsorption on a wall, by point.

    The settings are: `blocks`, the number of blocks of each replica; `layer_blocks`, this number for a wall
    with a layer; `near`, a distance from the edge of the well or from the sticky wall; and `bins`, the number
    of bins of speeds. The velocities of leaving particles are read within the distance `near`.

    The dimensions of the result are point and bin. Every point has kind, temperature, depth, width, momentum,
    mass and outside, as in `Holder`. The following variables have errors, with the suffix _error: `held`, the
    mean number of held particles; `ratio`, `held` divided by the number of other particles; `coverage`, the
    fraction of the wall's area that held particles cover; `gas_density`, far from both walls; `flux` (bin),
    the probability density of the normal speeds of leaving particles, in units of sqrt(kT/m); and
    `slow_share`, the fraction of speeds below `slow_speed`. The speed `slow_speed` is the limit of the sticky
    wall, and 1 for wells. `flux` and `slow_share` are NaN for layers. The gas at wide wells is ideal except
    for the volume that spheres exclude. Wide wells have `log_ratio`, ln of the ideal-gas ratio, and `length`,
    which replaces the thermal wavelength in this ratio. Layers have `activity`, beta P w e^(depth/kT) pi
    sigma^2/4; `filling`, the coverage divided by the coverage of hard discs in equilibrium with the gas (see
    `theory.adsorption.layer_activity`); and `filling_by_activity`, the same ratio with the activity of the
    gas instead of its pressure. Variables with the suffix `_freedom` are the degrees of freedom of the
    errors.
    """
    dataset = table("point", points, _measure_point, settings, inner=("bin",))
    return dataset.assign_coords(speed=("bin", _speeds(settings).middles[0])).set_coords("experiment")


def _speeds(settings: dict) -> Grid:
    return Grid.line(0.0, _REACH, settings["bins"])


def _measure_point(point: Point, settings: dict) -> dict[str, Any]:
    """Return the values of one point."""
    holder = Holder.of(point)
    slow = holder.momentum / np.sqrt(holder.mass * holder.temperature) or 1.0
    layer = holder.kind == "layer"
    number = settings["layer_blocks"] if layer else settings["blocks"]
    blocks = [
        counts_of(holder, *part, settings, slow)
        for run in runs(point)
        for part in _parts(holder, run, number)
    ]
    held, free, far, slowly, flux = (np.array(series) for series in zip(*blocks, strict=True))
    bins, absent = settings["bins"], (np.nan, np.nan)
    estimates = _amounts(holder, held, free, far) | {"log_ratio": absent, "length": absent}
    if holder.kind == "ideal":
        estimates |= _well(holder, held, free)
    if layer:  # hardly any particle leaves the layer
        estimates |= {"flux": (np.full(bins, np.nan),) * 2, "slow_share": absent}
        estimates |= _isotherm(holder, held, free, far)
    else:
        estimates |= _desorption(slowly, flux, _speeds(settings).volume)
        estimates |= {"activity": absent, "filling": absent, "filling_by_activity": absent}
    facts = ("kind", "temperature", "depth", "width", "momentum", "mass", "outside")
    return {
        "experiment": point.experiment,
        **{name: getattr(holder, name) for name in facts},
        "slow_speed": slow,
        **entries(estimates, len(held) - 1),
    }


def _amounts(holder: Holder, held: np.ndarray, free: np.ndarray, far: np.ndarray) -> dict[str, tuple]:
    """Compute (value, error) of the adsorbed amount and of the gas density, by name.

    The amounts are the number of held particles, its ratio to the number of free particles, and the coverage.
    """
    return {
        "held": jackknife(lambda inside: inside, held),
        "ratio": jackknife(lambda inside, others: inside / others, held, free),
        "coverage": jackknife(holder.coverage, held),
        "gas_density": jackknife(holder.gas_density, far),
    }


def _well(holder: Holder, held: np.ndarray, free: np.ndarray) -> dict[str, tuple]:
    """Compute (value, error) of the ideal-gas ratio, and of the length derived from it."""
    depth = holder.depth / holder.temperature

    def length(inside: np.ndarray, others: np.ndarray) -> np.ndarray:
        return length_in_langmuirs_formula(holder.ideal_ratio(inside, others), depth, holder.outside)

    return {
        "log_ratio": jackknife(lambda *counted: np.log(holder.ideal_ratio(*counted)), held, free),
        "length": jackknife(length, held, free),
    }


def _desorption(slowly: np.ndarray, flux: np.ndarray, width: float) -> dict[str, tuple]:
    """Compute (value, error) of the density of normal speeds, and of the slow fraction."""
    return {
        "flux": jackknife(lambda share: share / (share.sum() * width), flux),
        "slow_share": jackknife(lambda some, share: some / share.sum(), slowly, flux),
    }


def _isotherm(holder: Holder, held: np.ndarray, free: np.ndarray, far: np.ndarray) -> dict[str, tuple]:
    """Compute (value, error) of the activity of the gas, and of the relative coverage.

    The coverage is relative to hard discs in equilibrium with the gas.
    """

    def activity(counted: np.ndarray) -> float | np.ndarray:
        return holder.activity(holder.gas_density(counted))

    def filling(inside: np.ndarray, counted: np.ndarray, others: np.ndarray) -> float:
        density = holder.gas_density(counted)
        return holder.filling(float(inside), float(density), float(others))

    def by_activity(inside: np.ndarray, counted: np.ndarray) -> np.ndarray:
        return holder.coverage(inside) / packing_fraction_at(holder.fugacity(holder.gas_density(counted)), 2)

    return {
        "activity": jackknife(activity, far),
        "filling": jackknife(filling, held, far, free),
        "filling_by_activity": jackknife(by_activity, held, far),
    }


def counts_of(holder: Holder, height: np.ndarray, velocity: np.ndarray, settings: dict, slow: float) -> tuple:
    """Average counts of particles and fluxes over the frames of one block.

    The counts are for three groups: held particles, other particles, and gas particles at least a diameter
    from both walls (and from the well). The fluxes are for particles that leave the wall and are near it:
    particles with speeds below `slow`, and particles in each bin of speed (bins,). `height` (T, N) are
    heights of centres above the lowest position. `velocity` (T, N) is along x.
    """
    held = holder.holds(height, velocity)
    above = height - holder.width
    far = (above > 2.0 * holder.radius) & (above < holder.outside - 2.0 * holder.radius)
    leaving = ~held & (above < settings["near"]) & (velocity > 0.0)
    speed = velocity[leaving] / np.sqrt(holder.temperature / holder.mass)
    # a particle stays near for a time proportional to 1 / speed
    grid = _speeds(settings)
    flux = grid.sums(grid.cells(speed[:, None]), speed)
    frames = len(height)
    parts = held.sum(), (~held).sum(), far.sum(), speed[speed < slow].sum(), flux
    return tuple(part / frames for part in parts)


def _parts(holder: Holder, run: Run, blocks: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Return (height, velocity) of each block of a run."""
    run.block_length(blocks)
    height = run.data["coordinates"][1:, :, 0].values.astype(float) - holder.radius
    velocity = run.data["velocities"][1:, :, 0].values.astype(float)
    parts = (np.array_split(series, blocks) for series in (height, velocity))
    return zip(*parts, strict=True)
