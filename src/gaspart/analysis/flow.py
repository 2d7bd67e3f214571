"""Flow relative to which velocities, displacements and temperatures are measured.

By default, temperature, speeds, msd, vacf, D and all results of `by_species` are relative to the same local
flow. With about="rest" they are relative to the resting container.

Consider a group of particles in local equilibrium with total mass M and mean velocity u = sum m v / M. For a
component v of the velocity of a particle of mass m, <m (v - u)^2> = (1 - m / M) k_B T holds exactly for any
value of u. So the particle has 1 - m / M degrees of freedom per axis relative to u. The choice of the group
depends on how the gas can move:

- All particles of a frame form a group for the axes along which their total momentum is conserved.
- All particles that are in the same cell in any frame form a group if the flow is steady: between sliding
faces, under a force along a periodic axis, or in a `wind`. - All particles that are in the same cell in the
same frame form a group if the flow changes with time: if faces move along their normal, and between open
faces.

The known flow between sheared faces (`LeesEdwards`) is subtracted first.

A displacement relative to a steady flow is the displacement of the particle minus the time integral of the
flow at its position. The integral is computed by the trapezoidal rule over frames. Then <|dr|^2> is twice the
double time integral of the velocity autocorrelation relative to the flow. It contains no contribution of a
gradient of the flow (Taylor dispersion). Displacements relative to a flow that changes with time cannot be
computed from frames.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from gaspart.analysis.run_data import REST, RunData
from gaspart.errors import SceneError
from gaspart.scene.boundaries import flow
from gaspart.scene.faces import Vibrating

# Present container: moving faces, and the areas and volumes between them.


_POINTS = 2**14
_RATIOS = {2: 1.32471795724474602596, 3: 1.22074408460575947536}
"""Solutions x of x^(d + 1) = x + 1. Multiples of powers of 1/x, modulo 1, are evenly spread points (Roberts
2018).
"""
_INSTANTS = 64, 1024  # minimum and maximum number of instants per interval for a time average
_GOLDEN = 0.6180339887498949
_NUMBERS = 2_000_000  # maximum number of values for all intervals together


def sides(run: RunData, times: np.ndarray) -> np.ndarray:
    """Return the ends (S, d, 2) of the container at times (S,) of the run; pistons move uniformly between
    frames.
    """
    scene = run.scene
    ends = np.zeros((len(times), run.dimension, 2))
    ends[:, :, 1] = scene.container.lengths
    for number, face in scene.faces_of(Vibrating):
        inwards = face.places(times)
        ends[:, number // 2, number % 2] += -inwards if number % 2 else inwards
    for number, _ in scene.pistons:
        if "piston_position" not in run.data:
            raise SceneError("source", "frames", "lack the place of the piston")
        position = np.interp(times, run.time, run.data["piston_position"].values)
        ends[:, number // 2, number % 2] = position
    return ends


def accessible_lengths(run: RunData, times: np.ndarray) -> np.ndarray:
    """Return the sides (S, d) of the box that centres of the largest moving particles can reach at times
    (S,).
    """
    lower, upper = run.scene.reach(run.scene.largest_moving_radius)
    margins = np.array(run.scene.container.lengths) - np.subtract(upper, lower)
    return np.diff(sides(run, times), axis=2)[:, :, 0] - margins


def face_areas(run: RunData) -> np.ndarray:
    """Compute the area of each face by which a force or a flux is divided. The shape is (T - 1, 2d). The area
    is that part of a face that particle centres can reach, averaged over each interval between frames. For
    faces across the axis of a loaded piston it is the cross-section of the container, because the load is
    defined with this area. The area is NaN if particles of several sizes can reach different areas; then the
    run tallies the momentum per area. Scenes with moving faces contain no fixed particles or interior walls.
    """
    scene, intervals = run.scene, len(run.time) - 1
    if scene.has_unequal_areas:
        areas = np.full((1, 2 * run.dimension), np.nan)
    else:
        areas = run.accessible.areas(np.array([scene.largest_moving_radius]))
    if not scene.has_unequal_areas and scene.moving_axes:
        lower, upper = scene.reach(scene.largest_moving_radius)
        areas = areas + _mean_areas(run) - _across(np.subtract(upper, lower)[None]).repeat(2, axis=1)
    areas = np.array(np.broadcast_to(areas, (intervals, 2 * run.dimension)))
    if scene.load_axis is not None:
        loaded = slice(2 * scene.load_axis, 2 * scene.load_axis + 2)
        areas[:, loaded] = np.delete(scene.container.lengths, scene.load_axis).prod()
    return areas


def _mean_areas(run: RunData) -> np.ndarray:
    """Compute the mean area (T - 1, 2d) of each face in each interval, without obstacles."""
    intervals = len(run.time) - 1
    number = int(np.clip(_NUMBERS // intervals, *_INSTANTS))
    parts = (np.arange(number) + np.arange(1, number + 1) * _GOLDEN % 1.0) / number
    times = run.time[:-1, None] + np.diff(run.time)[:, None] * parts
    areas = _across(accessible_lengths(run, times.ravel()))
    return areas.reshape(intervals, number, run.dimension).mean(axis=1).repeat(2, axis=1)


def per_area(run: RunData, amounts: np.ndarray, tallied: str) -> np.ndarray:
    """Divide the amounts that each face receives per interval by the accessible area. If particles of several
    sizes can reach different areas, the result is a sum over sizes. Each term is the amount that particles of
    one size give, divided by the area that they can reach. The sum is read from the tally with the name
    `tallied`. In this case the result is NaN for faces whose area changes with time. Raises SceneError if the
    file does not contain the tally.
    """
    areas = face_areas(run)
    fluxes = amounts / areas.reshape(*areas.shape, *[1] * (amounts.ndim - 2))
    if not run.scene.has_unequal_areas:
        return np.asarray(fluxes)
    if tallied not in run.data:
        rule = (
            "particles of several sizes reach other areas of the faces; make the run again, or measure force"
        )
        raise SceneError(tallied, "missing", rule)
    faces = np.arange(2 * run.dimension)
    weighted = run.increments(tallied)[:, faces].astype(float)
    if weighted.ndim > amounts.ndim:
        weighted = weighted[:, faces, faces // 2]
    moved = {number // 2 for number, face in run.scene.numbered_faces if face.moves}
    weighted[:, [bool(moved - {face // 2}) for face in faces]] = np.nan
    is_known = np.isfinite(areas)  # cross-section for a piston with a load
    return np.asarray(
        np.where(is_known.reshape(*is_known.shape, *[1] * (amounts.ndim - 2)), fluxes, weighted)
    )


def _across(lengths: np.ndarray) -> np.ndarray:
    """Compute for each axis the product of the side lengths (..., d) along the other axes."""
    axes = range(lengths.shape[-1])
    return np.stack([np.delete(lengths, axis, axis=-1).prod(axis=-1) for axis in axes], axis=-1)


def accessible_fraction(run: RunData, radius: float, axis: int, edges: np.ndarray) -> np.ndarray:
    """Compute the fraction (bins,) of bins along `axis` that fixed particles leave to centres, by `_POINTS`
    points.
    """
    container, fixed = run.scene.container, ~np.isfinite(run.masses)
    lengths, widths = np.array(container.lengths), np.diff(edges)
    shares = np.empty(len(widths))
    from scipy.spatial import cKDTree

    ratio = _RATIOS[run.dimension] ** -np.arange(1.0, run.dimension + 1)
    points = np.outer(np.arange(_POINTS), ratio) % 1.0 * lengths
    across = points[:, axis] / lengths[axis]
    start = run.frame("coordinates", 0)
    centres = np.where(run.periodic, start % lengths, start)
    period = np.where(run.periodic, lengths, 0.0)
    sizes = np.unique(run.radii[fixed])
    trees = [cKDTree(centres[fixed & (run.radii == size)], boxsize=period) for size in sizes]
    for n, width in enumerate(widths):
        points[:, axis] = edges[n] + width * across
        is_free = np.ones(_POINTS, dtype=bool)
        for size, tree in zip(sizes, trees, strict=True):
            is_free &= ~np.isfinite(tree.query(points, distance_upper_bound=size + radius)[0])
        shares[n] = is_free.mean()
    return shares


# Equal cells along one or more axes, and sums over particles in them; all histograms of the analysis use
# them.


@dataclass(frozen=True)
class Grid:
    """Equal cells between `lower` (A,) and `upper` (A,), `numbers` (A,) along the axes."""

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    numbers: tuple[int, ...]

    @classmethod
    def line(cls, lower: float, upper: float, number: int) -> Grid:
        """Return a grid of cells along one axis."""
        return cls((float(lower),), (float(upper),), (int(number),))

    @cached_property
    def size(self) -> int:
        """Total number of cells."""
        return math.prod(self.numbers)

    @property
    def edges(self) -> list[np.ndarray]:
        """Edges of the cells along each axis, shape (cells + 1,)."""
        sides = zip(self.lower, self.upper, self.numbers, strict=True)
        return [np.linspace(low, high, number + 1) for low, high, number in sides]

    @property
    def middles(self) -> list[np.ndarray]:
        """Centres of the cells along each axis, shape (cells,)."""
        return [0.5 * (edge[1:] + edge[:-1]) for edge in self.edges]

    @property
    def volume(self) -> float:
        """Volume of a cell: the product of its side lengths along the axes of the grid."""
        sides = zip(self.lower, self.upper, self.numbers, strict=True)
        return math.prod((high - low) / number for low, high, number in sides)

    def cells(self, positions: np.ndarray, inside: bool = False) -> np.ndarray:
        """Return the cells of positions (..., A); -1 outside and for NaN, or the nearest if all are
        `inside`.
        """
        shape = np.shape(positions)[:-1]
        index, outside = np.zeros(shape, dtype=np.int64), np.zeros(shape, dtype=bool)
        for k, (low, high, number) in enumerate(zip(self.lower, self.upper, self.numbers, strict=True)):
            x = positions[..., k].astype(float)
            outside |= np.isnan(x) if inside else ~((x >= low) & (x <= high))
            x -= low
            x *= number / (high - low)
            np.fmax(x, 0.0, out=x)  # NaN becomes 0
            np.fmin(x, number - 1.0, out=x)
            index *= number
            index += x.astype(np.int64)
        index[outside] = -1
        return index

    def sums(
        self,
        cells: np.ndarray,
        weights: np.ndarray | None = None,
        blocks: np.ndarray | None = None,
        before: np.ndarray | None = None,
    ) -> np.ndarray:
        """Sum weights, or count particles, in each cell, shape (*numbers). `cells`: cell numbers, from
        `cells`. `weights`: array that broadcasts to the shape of `cells`. `blocks`: block number (T,) of each
        row of `cells` (T, ...). With block numbers, the result has one set of sums for each block, shape
        (blocks, *numbers). `before`: sums over earlier frames, to which the new terms are added. It has the
        shape of the result. The result is then bitwise identical to a single sum over all frames.
        """
        number = 1 if blocks is None else int(blocks.max(initial=-1)) + 1
        shape = self.numbers if blocks is None else (number, *self.numbers)
        if before is not None:
            number, shape = before.size // self.size, before.shape
        slot = cells + 1  # the first cell of each block collects the particles outside
        if blocks is not None:
            slot += (self.size + 1) * blocks.reshape(-1, *[1] * (cells.ndim - 1))
        slot, spread = slot.ravel(), None
        if weights is not None:
            spread = np.broadcast_to(weights, cells.shape).ravel()
            if before is not None:  # the first entry of each sum
                first = np.arange(number * (self.size + 1)).reshape(number, -1)[:, 1:]
                slot = np.concatenate([first.ravel(), slot])
                spread = np.concatenate([before.ravel(), spread])
        totals = np.bincount(slot, spread, minlength=number * (self.size + 1))
        totals = totals.reshape(number, -1)[:, 1:].reshape(shape)
        return totals if before is None or weights is not None else totals + before


_SAMPLES = 500  # minimum number of particles in frames per cell for an accurate steady flow
_CELLS = 20  # default number of cells along an axis
_CROWD = 8  # default number of particles per cell of a changing flow


@dataclass(frozen=True)
class Peculiar:
    """Velocities (T, M, d) of the M moving particles relative to the mean motion. `freedom` is the number of
    degrees of freedom of each velocity component: 1 minus the fraction that belongs to the mean motion.
    """

    velocities: np.ndarray
    freedom: np.ndarray

    def energies(self, masses: np.ndarray) -> np.ndarray:
        """Compute twice the kinetic energy (T, M) of each particle, from the masses (M,)."""
        return masses * sum_squares(self.velocities)

    def freedoms(self) -> np.ndarray:
        """Return the degrees of freedom of each particle, shape (T, M)."""
        components = (*self.freedom.shape[:2], self.velocities.shape[2])
        freedom = np.broadcast_to(self.freedom, components).sum(axis=2)
        return np.broadcast_to(freedom, self.velocities.shape[:2])


def sum_squares(vectors: np.ndarray) -> np.ndarray:
    """Sum the squares of components of (..., d), one by one: numpy is slow over a short last axis."""
    total = vectors[..., 0] ** 2
    for k in range(1, vectors.shape[-1]):
        total += vectors[..., k] ** 2
    return np.asarray(total)


def about_the_whole(run: RunData) -> Peculiar:
    """Compute velocities relative to the centre of mass, along conserved axes, and to a known
    sheared flow.
    """
    return about_the_mean(_about_known(run), run.masses[run.moving], run.conserved)


def about_the_mean(velocities: np.ndarray, masses: np.ndarray, axes: np.ndarray) -> Peculiar:
    """Compute velocities (T, M, d) relative to the centre of mass of masses (M,), along the axes (d,) of a
    mask.
    """
    total = masses.sum() or 1.0  # no particles: nothing to subtract
    drift = np.einsum("tnd,n->td", velocities, masses) / total
    apart = velocities.copy()
    for k in np.flatnonzero(axes):
        apart[..., k] -= drift[:, k, None]
    if (masses == masses[:1]).all():  # one value for all particles
        masses = masses[:1]
    return Peculiar(apart, np.where(axes, 1.0 - masses[:, None] / total, 1.0)[None])


def _about_known(run: RunData) -> np.ndarray:
    """Return velocities (T, M, d) of moving particles, relative to the flow of a sheared gas."""
    velocities = _chosen(run.velocities, run.moving)
    if run.scene.shear_rate is None:
        return velocities
    return velocities - flow(run.scene, _chosen(run.positions, run.moving))


def about_the_flow(run: RunData) -> Peculiar:
    """Compute the velocities in all frames relative to the mean motion (see `mean_motion`)."""
    return mean_motion(run)(run)


def mean_motion(
    run: RunData, along: Mapping[int, int] | None = None, local: bool = False
) -> Callable[[RunData], Peculiar]:
    """Return a function that computes the velocities in frames relative to the mean motion. If motion in the
    run is measured relative to rest, the function returns the velocities unchanged. Otherwise, if the gas can
    flow, velocities are relative to the local mass-weighted flow in cells along `flow_axes`. If the gas
    cannot flow, velocities are relative to the centre of mass. `along` maps an axis to a number of cells that
    replaces the default. If the flow is steady, further axes in `along` are also resolved. If `local` is
    True, velocities are always relative to the flow in these cells.
    """
    across, stated = run.flow_axes, dict(along or {})
    if not across and local:
        return partial(about_cells, cells=steady_cells(run, stated))
    if run.about == REST:
        return _about_rest
    if not across:
        return about_the_whole
    changes = run.scene.flow_changes
    axes = across if changes else sorted({*across, *stated})
    numbers = {axis: stated.get(axis, _number(run, axes, changes)) for axis in axes}
    return partial(about_cells, cells=FlowCells(run, numbers) if changes else steady_cells(run, numbers))


def _about_rest(run: RunData) -> Peculiar:
    """Return the velocities of the moving particles unchanged."""
    velocities = _chosen(run.velocities, run.moving)
    return Peculiar(velocities, np.ones((1, velocities.shape[1], 1)))


def _number(run: RunData, axes: list[int], changes: bool) -> int:
    """Return the number of cells along each of the axes."""
    particles = int(run.moving.sum())
    samples = particles / _CROWD if changes else particles * len(run.time) / _SAMPLES
    return int(np.clip(samples ** (1.0 / len(axes)), 1, _CELLS))


class FlowCells:
    """Cells, `numbers` by axis, of the flow velocity: stored sums if it is steady, else means of
    each frame.
    """

    def __init__(self, run: RunData, numbers: Mapping[int, int]) -> None:
        self._axes = list(numbers)
        lengths = np.array(run.scene.container.lengths)[self._axes]
        self.grid = Grid((0.0,) * len(self._axes), tuple(lengths.tolist()), tuple(numbers.values()))
        self.sums: list[np.ndarray] | None = None

    def cells(self, part: RunData) -> np.ndarray:
        """Return the cell number (T, M) of each moving particle."""
        return self.grid.cells(_chosen(part.positions, part.moving)[..., self._axes], inside=True)

    def sum(
        self, cells: np.ndarray, masses: np.ndarray, velocities: np.ndarray, before: list | None
    ) -> list[np.ndarray]:
        """Sum mass and momentum in cells: (T, C) if the flow changes with time, else (C,), added to earlier
        sums.
        """
        blocks = np.arange(len(cells)) if before is None else None
        weights = [masses, *(masses * velocities[..., k] for k in range(velocities.shape[-1]))]
        sums = before or [None] * len(weights)
        return [self.grid.sums(cells, each, blocks, total) for each, total in zip(weights, sums, strict=True)]


def steady_cells(run: RunData, numbers: Mapping[int, int]) -> FlowCells:
    """Return the cells of a steady flow with the mass and momentum summed over all frames."""
    flow_cells = FlowCells(run, numbers)
    sums = [np.zeros(flow_cells.grid.numbers) for _ in range(1 + run.dimension)]
    for _, part in run.parts():
        sums = flow_cells.sum(flow_cells.cells(part), part.masses[part.moving], _about_known(part), sums)
    flow_cells.sums = sums
    return flow_cells


def about_cells(run: RunData, cells: FlowCells) -> Peculiar:
    """Compute velocities relative to the mass-weighted mean velocity in the cells."""
    numbers, velocities, masses = cells.cells(run), _about_known(run), run.masses[run.moving]
    sums, groups = cells.sums, numbers
    if sums is None:
        sums = cells.sum(numbers, masses, velocities, None)
        groups = numbers + cells.grid.size * np.arange(len(numbers))[:, None]
    weight, *momenta = (values.ravel() for values in sums)
    means = np.empty_like(velocities)
    for k, momentum in enumerate(momenta):
        means[..., k] = np.divide(momentum, weight, out=np.zeros(weight.size), where=weight > 0.0)[groups]
    shares = np.divide(masses, weight[groups], out=np.ones(numbers.shape), where=numbers >= 0)
    return Peculiar(velocities - means, (1.0 - shares)[..., None])


def _chosen(values: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Return the values (T, M, d) of the moving particles, contiguous in memory."""
    return values if moving.all() else values.compress(moving, axis=1)
