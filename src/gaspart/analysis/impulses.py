"""Density along an axis from the momentum that particles carry through planes across the axis.

This momentum is computed from impulses, without the noise of counting particles (`Tally.momentum_flux_sum`;
docs/estimators.md contains the derivation). Through a plane of area A at the density rho, the momentum per
time is A rho <m v^2>. In equilibrium <m v^2> of a particle at the plane is known, so the rate determines rho.
In a dilute gas and in narrow bins, counting is noisier than the impulses. For long density waves of a dense
gas, counting is less noisy. So both estimates are combined in each bin as a weighted mean. The weights for
one half of the run are computed from the other half. So the weights are independent of the noise that they
multiply.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np
import xarray as xr

from gaspart.analysis.profiles import BLOCKS, LEAST_FRAMES, Cells, Means, ratio
from gaspart.analysis.run import Run
from gaspart.engines import ENGINES, Engine
from gaspart.errors import SceneError
from gaspart.scene.scene import Scene
from gaspart.state.optional_tallies import OptionalTally
from gaspart.state.tally import ImpulseTally
from gaspart.trajectory.run_options import stored_tally

# How an observable was estimated, and which data a run must store for a better estimate.


def engine_class(run: Run) -> type[Engine]:
    """Return the engine's class; the base, which declares no capabilities, if the file names none."""
    return ENGINES.get(json.loads(run.data.attrs.get("engine", "{}")).get("name"), Engine)


def engine_tallies(run: Run) -> frozenset[str]:
    """Return the names of the optional tallies that the engine of a run can make."""
    return engine_class(run).tallies


def knows_energies(engine: Engine | type[Engine], scene: Scene) -> bool:
    """Return True if the mean kinetic energy along each axis is known exactly. This requires an engine
    without a systematic error, and a scene in which the energy is equally distributed among the axes. An
    engine with time steps has such an error near a wall, because particles cross the wall within a step.
    """
    return engine.reference and scene.shares_energy_evenly


def estimator(
    run: Run, usual: str, better: str, used: bool, tally: OptionalTally | None, lacks: str = ""
) -> dict[str, str]:
    """Return the attributes that name the data from which an observable was estimated. The attribute
    `estimator` is the text `better` if `used` is True, otherwise `usual`. If the usual estimator was used,
    but the scene and the engine allow a run to store `tally`, a note recommends the option. If `lacks` is not
    empty, the note instead states which data the stored tally does not contain.
    """
    if used:
        return {"estimator": better}
    attributes = {"estimator": usual}
    if tally is None or tally.name not in engine_tallies(run):
        return attributes
    try:
        tally.check(run.scene)
    except SceneError:
        return attributes
    advice = f"a run with {tally.option} makes it more accurate"
    return {**attributes, "note": f"by {usual}; {lacks or advice}"}


USUAL_BINS = 40
"""Default number of bins of a profile if the run has not stored impulses."""
_ROUNDING = 1e-10
"""Density that is attributed to rounding, as a fraction of the highest density."""
_GROUPS = 16
"""Number of parts into which half of a run is divided to estimate a weight. In a long run each part is longer
than the correlation time.
"""
_NEIGHBOURS = 0.02
"""Distance within which bins on both sides contribute to a common weight, as a fraction of the container's
length.
"""


@dataclass(frozen=True)
class MomentumFlux:
    """Momentum that one species carries through the planes between bins, in M intervals.

    flux : (M, bins), see `Tally.momentum_flux_sum`.
    time : (M,), durations of the intervals.
    count : number of particles.
    spread : (bins,), mean of m v^2 along the axis for a particle in each bin.
    above : (bins,), mean distance from a particle to the upper end of its bin, divided by the bin width.
    reached : (bins,), True if particles can be in the bin.
    width : width of a bin.
    pull : force of gravity on a particle along the axis.
    walled : True if faces bound the axis.
    """

    flux: np.ndarray
    time: np.ndarray
    count: int
    spread: np.ndarray
    above: np.ndarray
    reached: np.ndarray
    width: float
    pull: float
    walled: bool

    def numbers(self) -> np.ndarray:
        """Compute the number of particles in each bin integrated over time (M, bins); sums over bins are
        exact.
        """
        if self.pull > 0.0:  # start at the lower side, so that no error grows with the density
            below = self.pull * self.count * self.time[:, None]
            flipped = MomentumFlux(
                (self.flux + below)[:, ::-1],
                self.time,
                self.count,
                self.spread[::-1],
                1.0 - self.above[::-1],
                self.reached[::-1],
                self.width,
                -self.pull,
                self.walled,
            )
            return flipped.numbers()[:, ::-1]
        content = self._fallen() if self.pull else self.flux * (self.width / self.spread)
        content = np.where(self.reached, content, 0.0)
        total = self.count * self.time
        if self.walled:
            content *= (
                total.sum() / content.sum()
            )  # a missing number is then distributed in proportion to the density
            shares = content.sum(axis=0) / total.sum()
        else:
            shares = np.full(content.shape[1], 1.0 / content.shape[1])
        return content + (total - content.sum(axis=1))[:, None] * shares

    def _fallen(self) -> np.ndarray:
        """Compute the numbers of particles under gravity, which changes the momentum of particles. For the
        planes of a bin, these are all particles in lower bins and, on average, a fraction of the particles in
        the bin itself.
        """
        numbers, below = np.empty(self.flux.shape), np.zeros(len(self.flux))
        shares = self.spread / self.width - self.pull * self.above
        for k, flux in enumerate(self.flux.T):
            numbers[:, k] = (flux + self.pull * below) / shares[k]
            below += numbers[:, k]
        return numbers


def useful_impulses(scene: Scene, tallies: Collection[str], axis: int, bins: int) -> tuple[ImpulseTally, ...]:
    """Return the impulse tally along an axis; () if it cannot determine the density. `tallies`: names of the
    tallies that the engine can store.
    """
    tally = ImpulseTally("xyz"[axis], bins)
    try:
        tally.check(scene)
    except SceneError:
        return ()
    one_mass = all(kind.alike for kind in scene.kinds)
    pulled = bool(scene.gravity and scene.gravity[axis])
    by_mass = pulled or scene.container.periodic[axis]
    return (tally,) if tally.name in tallies and (one_mass or not by_mass) else ()


def usual_tally(axis: str) -> ImpulseTally:
    """Return the options of an impulse tally along an axis, with `USUAL_BINS` bins."""
    return ImpulseTally(axis, USUAL_BINS)


def read_impulses(data: xr.Dataset) -> ImpulseTally | None:
    """Read the impulse tallies of a trajectory."""
    return stored_tally(data.attrs, ImpulseTally)


def numbers_by_impulses(run: Run, axis: int, bins: int, species: int | None) -> np.ndarray | None:
    """Compute the moving particles in each bin, integrated over intervals, (T - 1, bins); None
    without data.
    """
    has = read_impulses(run.data)
    if has is None or has.axis != "xyz"[axis] or has.bins % bins:
        return None
    rows = [n for n in np.unique(run.species) if species is None or n == species]
    fluxes = [_momentum_flux(run, axis, has.bins, int(row)) for row in rows]
    if any(flux is None or not flux.flux.any() for flux in fluxes):  # without impulses nothing is known
        return None
    fine = np.asarray(sum(flux.numbers() for flux in fluxes if flux is not None))
    return fine.reshape(len(fine), bins, -1).sum(axis=2)


def _momentum_flux(run: Run, axis: int, bins: int, row: int) -> MomentumFlux | None:
    """Return the momentum flux of a row of the tally; None for several masses or an unknown temperature."""
    members = run.species == row
    masses = run.masses[members]
    pull = (run.scene.gravity or (0.0,) * run.dimension)[axis]
    walled = not run.periodic[axis]
    if np.ptp(masses) > 0.0 and (pull or not walled):
        return None
    if run.is_subset and not _uniform(run, walled):
        return None
    flux = np.diff(run.data["momentum_flux_sum"].values[:, row], axis=0)
    spread, above = np.ones(bins), np.full(bins, 0.5)
    if not run.is_subset:
        cells = Cells(run, np.flatnonzero(members), (axis,), (bins,))
        spread, above = _spread(run, axis, bins, members, cells), _above(run, axis, cells)
    width, force = float(run.scene.container.lengths[axis]) / bins, float(masses[0] * pull)
    time, count = np.diff(run.time), int(members.sum())
    low, high = (side[axis] for side in run.scene.reach(float(run.radii[members].min())))
    edges = width * np.arange(bins + 1)
    reached = (edges[1:] > low) & (edges[:-1] < high)
    return MomentumFlux(flux, time, count, spread, above, reached, width, force, walled)


def _uniform(run: Run, walled: bool) -> bool:
    """Return True if the density is proportional to the momentum flux, whatever the temperature."""
    return walled and not _has_potential(run)


def _has_potential(run: Run) -> bool:
    """Return True if gravity or potential wells act on particles."""
    return run.has_gravity or any(face.kind == "well" for face in run.scene.faces.values())


def _spread(run: Run, axis: int, bins: int, members: np.ndarray, cells: Cells) -> np.ndarray:
    """Compute <m v^2> along an axis for a particle in each bin, shape (bins,). All particles in the mask
    `members` (N,) have the same mass. If faces have a temperature, this temperature determines the result.
    Otherwise the energy of the gas is constant, and the kinetic energy is the total energy minus the
    potential energy. The temperature at a position is then the mean over the states that have a particle at
    this position. If the momentum is conserved, the result is corrected for the motion of the centre of mass.
    """
    hot = run.scene.face_temperatures
    spread = np.full(bins, min(hot) if hot else run.temperature)
    if _has_potential(run) and not hot:
        spread = _mean_in(
            cells, lambda part, _: run.temperatures[np.searchsorted(run.time, part.time), None], spread
        )
    if not run.conserved[axis]:
        return spread
    total_mass, mass = run.masses.sum(), run.masses[members][0]
    drift = float(run.masses @ run.frame("velocities", 0)[:, axis]) / total_mass
    return spread * (1.0 - mass / total_mass) + mass * drift**2


def _above(run: Run, axis: int, cells: Cells) -> np.ndarray:
    """Compute the mean distance (bins,) to the upper end of the bin over its width; one half without
    particles.
    """
    scale = cells.numbers[0] / run.scene.container.lengths[axis]
    return _mean_in(
        cells,
        lambda part, numbers: numbers + 1.0 - part.positions[:, cells.members, axis] * scale,
        np.full(cells.numbers, 0.5),
    )


def _mean_in(cells: Cells, of: Callable[[Run, np.ndarray], np.ndarray], default: np.ndarray) -> np.ndarray:
    """Average the values `of` a part of the run (T, n) in each bin; an empty bin has the value `default`."""
    number, total = (each.sum(axis=0) for each in cells.sums(lambda part, numbers: [None, of(part, numbers)]))
    return np.divide(total, number, out=default, where=number > 0)


def mixture(counted: np.ndarray, impulses: np.ndarray, periodic: bool) -> np.ndarray:
    """Compute the weights (K, bins) of the impulse estimate in the weighted mean with counts. `counted` and
    `impulses` are the estimates in blocks (K, bins). The weights for each half of the blocks are computed
    from the other half. The weights are between 0 and 1. If `periodic` is True, the first bin is a neighbour
    of the last one.
    """
    half = len(counted) // 2
    first = _weights(counted[:half], impulses[:half], periodic)
    second = _weights(counted[half:], impulses[half:], periodic)
    return np.where(np.arange(len(counted))[:, None] < half, second, first)


def _weights(counted: np.ndarray, impulses: np.ndarray, periodic: bool) -> np.ndarray:
    """Compute the weights (bins,), common to neighbours, of the weighted mean with the least variance."""
    groups = np.arange(len(counted)) * min(_GROUPS, len(counted)) // len(counted)
    starts = np.flatnonzero(np.diff(groups, prepend=-1))
    sizes = np.diff(np.append(starts, len(counted)))[:, None]
    means = [np.add.reduceat(values, starts) / sizes for values in (counted, counted - impulses)]
    own, apart = (mean - mean.mean(axis=0) for mean in means)
    reach = max(1, round(_NEIGHBOURS * counted.shape[1]))
    common, square = (_near(values.sum(axis=0), reach, periodic) for values in (own * apart, apart**2))
    return np.clip(np.divide(common, square, out=np.zeros(len(common)), where=square > 0.0), 0.0, 1.0)


def _near(values: np.ndarray, reach: int, periodic: bool) -> np.ndarray:
    """Sum, for each bin, the values of all bins that are at most `reach` bins away."""
    extended = np.pad(values, reach, "wrap" if periodic else "constant")
    cumulative = np.concatenate([[0.0], np.cumsum(extended)])
    width = 2 * reach + 1
    return np.asarray(cumulative[width:] - cumulative[:-width])


def mixed_density(run: Run, axis: int, bins: int, species: int | None) -> Means | None:
    """Compute the density along an axis from counts and impulses; None without stored impulses."""
    frames = len(run.time)
    if run.is_subset and len(run.scene.kinds) > 1:
        return None
    numbers = numbers_by_impulses(run, axis, bins, species)
    if numbers is None or frames <= LEAST_FRAMES:
        return None
    members = np.flatnonzero(run.species == (run.species if species is None else species))
    stored = members[members < run.data.sizes["atom"]]
    cells = Cells(run, stored, (axis,), (bins,))
    blocks = np.arange(frames - 1) * min(BLOCKS, frames - 1) // (frames - 1)
    starts = np.flatnonzero(np.diff(blocks, prepend=-1))
    time = np.add.reduceat(np.diff(run.time), starts)[:, None]
    volume = cells.grid.volume * np.delete(run.scene.container.lengths, axis).prod()
    impulses = np.add.reduceat(numbers, starts) / (time * volume)
    impulses[np.abs(impulses) < _ROUNDING * impulses.max()] = 0.0
    counts = np.zeros((blocks[-1] + 1, bins), dtype=int)
    for part_frames, part in run.parts():
        first = int(part_frames.start == 0)  # an interval belongs to the frame at its end
        within = blocks[part_frames.start - 1 + first : part_frames.stop - 1]
        counts = cells.grid.sums(cells.cells_of(part)[first:], None, within, counts)
    counted = counts * (len(members) / len(stored)) / (np.bincount(blocks)[:, None] * volume)
    weights = mixture(counted, impulses, run.periodic[axis])
    mixed = counted + weights * (impulses - counted)
    shares = mixed.mean(axis=0) / mixed.mean(axis=0).sum()
    mixed += (len(members) / volume - mixed.sum(axis=1))[:, None] * shares  # weights differ between bins
    return ratio(mixed * time, np.broadcast_to(time, mixed.shape), counted=True)


def default_bins(run: Run, axis: int, of: str) -> int:
    """Return the default number of bins along an axis; for a density that of the stored impulses."""
    has = read_impulses(run.data)
    return has.bins if of == "density" and has is not None and has.axis == "xyz"[axis] else USUAL_BINS


def described_density(run: Run, axis: int, bins: int, by_impulses: bool) -> dict[str, str]:
    """Return the attributes that name a density's data (`estimator`), with a note if impulses do not fit."""
    has, tallies = read_impulses(run.data), useful_impulses(run.scene, engine_tallies(run), axis, 200)
    lacks = ""
    if has is not None and has.axis == "xyz"[axis] and has.bins % bins:
        lacks = f"impulses are kept in {has.bins} bins, which {bins} do not divide"
    of = "counts", "counts and impulses"
    return estimator(run, *of, by_impulses, tallies[0] if tallies else None, lacks)


# Control variates: quantities that fluctuate together with a mean over time and whose own mean is known
# exactly.
#
# A wall receives the momentum that particles carry to it. The virial theorem along its normal applies, for
# particles of one size between two walls, whose centres can move a distance h:
#
#     (I_low + I_high) h / 2 = int dt sum m v^2 + sum of r dp over contacts - change of sum m x v,
#
# x is measured from the middle, and I_low - I_high is the change of the momentum. On the right-hand side, all
# terms except the collisional one have known means. Both changes have the mean 0. The mean of sum m v^2
# follows from equal sharing of the energy among directions. Their deviations from these means are
# subtracted, multiplied by regression coefficients (docs/estimators.md).


_LEAST, _MOST = 32, 128
"""Minimum and maximum number of groups of intervals into which a run is divided. Regression coefficients are
estimated from half of the groups. With fewer groups no coefficients are estimated; more groups give no
improvement. In each group a particle collides at least once, so that its energy is redistributed among
directions.
"""
FEWEST = 10
"""Minimum number of moving particles for control variates of pressures. Fewer particles redistribute their
energy among directions too slowly for a regression. For two discs in a container of 2.6 x 2.9, only 52 of 60
values were within two standard errors.
"""


def wall_controls(run: Run, axis: int) -> np.ndarray | None:
    """Compute control variates (T - 1, 3) of the impulses across an axis, per time. The control variates are
    the deviation of sum m v^2 along the axis from its known mean, and the changes of the momentum and of sum
    m x v along the axis. Return None unless the run has stored impulses along this axis and the states of all
    particles, and is in equilibrium at a constant kinetic energy.
    """
    has = read_impulses(run.data)
    if has is None or has.axis != "xyz"[axis] or not run.has_states:
        return None
    if not knows_energies(engine_class(run), run.scene):
        return None
    time = np.diff(run.time)
    width = float(run.scene.container.lengths[axis]) / has.bins
    carried = run.increments("momentum_flux_sum").sum(axis=(1, 2)) * width / time
    changes = np.diff(stores(run)[axis], axis=0) / time[:, None]
    return np.column_stack([carried - run.scene.moving_count * run.temperature, changes])


def stores(run: Run) -> np.ndarray:
    """Compute momentum and sum of m x v, x from the middle, along each axis, (d, T, 2); (d, T, 0) if not all
    are stored.
    """
    if not run.has_states:
        return np.zeros((run.dimension, len(run.time), 0))
    moving, masses, sums = run.moving, run.masses[run.moving], []
    for _, part in run.parts():
        velocities = part.velocities[:, moving]
        centred = part.positions[:, moving] - 0.5 * np.array(run.scene.container.lengths)
        momentum = np.einsum("tnd,n->dt", velocities, masses)
        sums.append(np.stack([momentum, np.einsum("tnd,tnd,n->dt", centred, velocities, masses)], axis=2))
    return np.concatenate(sums, axis=1)


def group_count(run: Run) -> int:
    """Return the number of groups of intervals for a regression; 0 if there are too few."""
    if run.moving.sum() < FEWEST:
        return 0
    collided = 2.0 * run.increments("collisions").sum() / max(1, int(run.moving.sum()))
    number = min(_MOST, len(run.time) - 1, int(collided))
    return number if number >= _LEAST else 0


def subtract_controls(series: np.ndarray, controls: np.ndarray, groups: int) -> np.ndarray:
    """Subtract from a series (K,) the part that is correlated with control variates (K, R). The control
    variates have a mean of 0. The coefficients for each half of the series come from a regression on the
    other half, in `groups` / 2 groups of consecutive values. So the coefficients are independent of the noise
    that they multiply, and the mean of the result is unbiased.
    """
    half, residual = len(series) // 2, series.copy()
    first, second = slice(None, half), slice(half, None)
    for used, other in ((first, second), (second, first)):
        values = np.column_stack([series[other], controls[other]])
        means = np.stack([part.mean(axis=0) for part in np.array_split(values, groups // 2)])
        means -= means.mean(axis=0)
        residual[used] -= controls[used] @ np.linalg.lstsq(means[:, 1:], means[:, 0], rcond=None)[0]
    return residual
