"""Metropolis sampling of hard bodies, and insertion of trial bodies: static averages without dynamics.

Nothing of gaspart is imported. k_B T is that of the scene's faces, 1 without one.
"""

import math
from typing import NamedTuple

import numpy as np
from exact.bodies import OPEN, PERIODIC, WALL
from numba import njit

BLOCKS = 20
"""Blocks of a series, whose scatter is its standard error."""
PLANE_STEP = 0.1
"""Largest change of a moving face or wall, as a fraction of the length of the container."""


class Bodies(NamedTuple):
    """Arrays of all bodies, the fixed ones first; own: radii for contact with each other, which are smaller
    while a start is made."""

    radii: np.ndarray
    own: np.ndarray
    masses: np.ndarray
    sides: np.ndarray
    fixed: int


class Plan(NamedTuple):
    """Course of a walk: activity of insertions (0 without), force on a piston (0 without), its farthest
    place, whether a wall between two gases moves, number of sweeps, and sweeps between configurations that
    are kept."""

    activity: float
    load: float
    farthest: float
    parted: bool
    sweeps: int
    every: int


class Sample(NamedTuple):
    """Kept configurations: positions (S, N, d), numbers of bodies (S,), places (S,) of the moving face or
    wall, and of all bodies the radii, the masses, the groups (-1 fixed) and the sides."""

    positions: np.ndarray
    numbers: np.ndarray
    places: np.ndarray
    radii: np.ndarray
    masses: np.ndarray
    groups: np.ndarray
    sides: np.ndarray


@njit(cache=True)
def potential(x, radius, mass, side, box):
    """Return the potential energy of a body in the walls and fields, inf where it may not be."""
    energy = 0.0
    for k in range(len(box.lengths)):
        energy -= mass * box.gravity[k] * x[k]
        for s in range(2):
            gap = box.lengths[k] - x[k] if s else x[k]
            if box.boundary[k, s] == WALL:
                if gap < box.margin * radius - 1e-12:
                    return np.inf
                if box.wells[k, s, 0] > 0.0 and gap - radius < box.wells[k, s, 1]:
                    energy -= box.wells[k, s, 0]
            elif box.boundary[k, s] == OPEN and gap < 0.0:
                return np.inf
    if side != 0 and (x[box.axis] - box.plane[0]) * side < radius - 1e-12:
        return np.inf
    for f in range(len(box.plates)):
        apart = x - box.plates[f, 0]
        for q in range(1, 3):
            edge = box.plates[f, q]
            square = (edge * edge).sum()
            if square > 0.0:
                part = ((x - box.plates[f, 0]) * edge).sum() / square
                apart = apart - min(1.0, max(0.0, part)) * edge
        if (apart * apart).sum() < radius * radius * (1.0 - 1e-12):
            return np.inf
    return energy


@njit(cache=True)
def overlaps(x, radius, positions, radii, skip, box):
    """Return True if a body overlaps one of the others."""
    for j in range(len(positions)):
        if j != skip:
            square = 0.0
            for k in range(len(box.lengths)):
                apart = x[k] - positions[j, k]
                if box.boundary[k, 0] == PERIODIC:
                    apart -= box.lengths[k] * np.rint(apart / box.lengths[k])
                square += apart * apart
            if square < (radius + radii[j]) ** 2:
                return True
    return False


@njit(cache=True)
def displace(positions, i, step, bodies, box):
    """Try to move body i by up to `step` along each axis; return True if it has moved."""
    d = len(box.lengths)
    x = np.empty(d)
    for k in range(d):
        x[k] = positions[i, k] + (2.0 * np.random.random() - 1.0) * step
        if box.boundary[k, 0] == PERIODIC:
            x[k] -= box.lengths[k] * math.floor(x[k] / box.lengths[k])
    energy = potential(x, bodies.radii[i], bodies.masses[i], bodies.sides[i], box)
    if energy == np.inf or overlaps(x, bodies.own[i], positions, bodies.own, i, box):
        return False
    change = energy - potential(positions[i], bodies.radii[i], bodies.masses[i], bodies.sides[i], box)
    if change > 0.0 and np.random.random() > math.exp(-change / box.temperature):
        return False
    positions[i] = x
    return True


@njit(cache=True)
def exchange(positions, n, activity, bodies, box):
    """Try to insert or remove a body; return the number of bodies."""
    expected = activity * box.lengths.prod()
    moving = n - bodies.fixed
    if np.random.random() < 0.5:
        if n == len(positions):
            return n
        x = np.random.random(len(box.lengths)) * box.lengths
        if np.random.random() * (moving + 1) < expected:
            if not overlaps(x, bodies.own[n], positions[:n], bodies.own, -1, box):
                energy = potential(x, bodies.radii[n], bodies.masses[n], 0, box)
                if energy < np.inf and np.random.random() < math.exp(-energy / box.temperature):
                    positions[n] = x
                    return n + 1
    elif moving > 0:
        i = np.random.randint(bodies.fixed, n)
        energy = potential(positions[i], bodies.radii[i], bodies.masses[i], 0, box)
        if np.random.random() * expected < moving * math.exp(min(50.0, energy / box.temperature)):
            positions[i] = positions[n - 1]
            return n - 1
    return n


@njit(cache=True)
def all_fit(positions, bodies, box):
    """Return True if no body overlaps a wall."""
    for i in range(bodies.fixed, len(positions)):
        if potential(positions[i], bodies.radii[i], bodies.masses[i], bodies.sides[i], box) == np.inf:
            return False
    return True


@njit(cache=True)
def move_piston(positions, bodies, box, plan):
    """Try to move the high face of the axis, against its load, by a fraction of the length."""
    old = box.lengths[box.axis]
    change = (2.0 * np.random.random() - 1.0) * PLANE_STEP * old
    new = old + change
    # The step is a fraction of the length: its reverse must exist, and has the density old / new.
    if new > plan.farthest or abs(change) > PLANE_STEP * new:
        return
    box.lengths[box.axis] = new
    if (
        not all_fit(positions, bodies, box)
        or np.random.random() > math.exp(-plan.load * change / box.temperature) * old / new
    ):
        box.lengths[box.axis] = old


@njit(cache=True)
def move_wall(positions, bodies, box):
    """Try to move the wall between two gases."""
    old = box.plane[0]
    box.plane[0] = old + (2.0 * np.random.random() - 1.0) * PLANE_STEP * box.lengths[box.axis]
    if not all_fit(positions, bodies, box):
        box.plane[0] = old


@njit(cache=True)
def walk(positions, n, bodies, box, plan, steps, seed, kept):
    """Make sweeps of moves; return the number of bodies and the accepted fraction of the moves of each.

    A sweep has a fixed number of moves: moves in proportion to a number of bodies that varies would weight
    configurations of few bodies too much.
    """
    np.random.seed(seed)
    moves = max(1, n - bodies.fixed)
    if plan.activity > 0.0:
        moves = 2 * max(4, int(plan.activity * box.lengths.prod()))
    tried, done, stored = np.ones(len(positions)), np.zeros(len(positions)), 0
    for sweep in range(plan.sweeps):
        for _ in range(moves):
            if plan.activity > 0.0 and np.random.random() < 0.5:
                n = exchange(positions, n, plan.activity, bodies, box)
            elif n > bodies.fixed:
                i = np.random.randint(bodies.fixed, n)
                tried[i] += 1.0
                done[i] += displace(positions[:n], i, steps[i], bodies, box)
        for _ in range(4):
            if plan.load > 0.0:
                move_piston(positions[:n], bodies, box, plan)
            if plan.parted:
                move_wall(positions[:n], bodies, box)
        if sweep % plan.every == plan.every - 1 and stored < len(kept.numbers):
            kept.positions[stored, :n] = positions[:n]
            kept.numbers[stored] = n
            kept.places[stored] = box.plane[0] if plan.parted else box.lengths[box.axis]
            stored += 1
    return n, done / tried


def sample(case, configurations, every=2, seed=0, less=None):
    """Sample configurations of a case, with one body of group `less` fewer."""
    rng = np.random.default_rng(seed)
    box = case.box._replace(lengths=case.box.lengths.copy(), plane=case.box.plane.copy())
    radii, masses, groups, sides = case.bodies(less)
    fixed = len(case.fixed)
    if case.activity:
        room = int(20 + 3 * case.activity * box.lengths.prod())
        radii, masses = np.full(room, case.groups[0].radius), np.full(room, case.groups[0].mass)
        groups = sides = np.zeros(room, int)
    radii, masses = np.append(case.fixed_radii, radii), np.append(np.full(fixed, np.inf), masses)
    groups, sides = np.append(np.full(fixed, -1), groups), np.append(np.zeros(fixed, int), sides)
    bodies = Bodies(radii, radii, masses, sides, fixed)
    positions, n, steps = _start(case, box, bodies, rng)
    kept = Sample(
        np.zeros((configurations, len(radii), case.dimension)),
        np.zeros(configurations, int), np.zeros(configurations), radii, masses, groups, sides,
    )  # fmt: skip
    farthest = float(case.box.lengths[box.axis])
    plan = Plan(case.activity, case.load, farthest, box.plane[0] >= 0.0, configurations * every, every)
    walk(positions, n, bodies, box, plan, steps, int(rng.integers(2**31)), kept)
    return kept


def _start(case, box, bodies, rng):
    """Return positions, the number of bodies and the lengths of steps after equilibration.

    Bodies begin as points anywhere, and grow together to their sizes.
    """
    fixed, d = bodies.fixed, case.dimension
    total = len(bodies.radii)
    n = fixed if case.activity else total
    positions = np.zeros((total, d))
    positions[:fixed] = case.fixed
    for i in range(fixed, n):
        while True:
            x = rng.random(d) * box.lengths
            free = potential(x, bodies.radii[i], 1.0, bodies.sides[i], box) < np.inf
            if free and not overlaps(x, 0.0, positions[:fixed], bodies.radii, -1, box):
                positions[i] = x
                break
    steps = np.full(total, 0.2 * (box.lengths.prod() / max(1, n - fixed)) ** (1.0 / d))
    grown = 0
    while grown < 40:
        own = bodies.radii.copy()
        if n > fixed and not case.activity:
            own[fixed:] *= min(1.0, 0.9999 * _room_to_grow(positions, bodies, box))
        grown += bool((own == bodies.radii).all())
        farthest, parted = float(case.box.lengths[box.axis]), bool(grown and box.plane[0] >= 0.0)
        plan = Plan(case.activity, case.load if grown else 0.0, farthest, parted, 50, 50)
        none = Sample(
            np.zeros((0, total, d)), np.zeros(0, int), np.zeros(0),
            bodies.radii, bodies.masses, bodies.sides, bodies.sides,
        )  # fmt: skip
        seed = int(rng.integers(2**31))
        n, accepted = walk(positions, n, bodies._replace(own=own), box, plan, steps, seed, none)
        steps = np.clip(steps * np.where(accepted > 0.4, 1.15, 0.87), 1e-5, box.lengths.min() / 2.0)
    return positions, n, steps


def _room_to_grow(positions, bodies, box):
    """Return the fraction of their radii that moving bodies may have without overlaps."""
    fixed, radii = bodies.fixed, bodies.radii
    apart = positions[fixed:, None] - positions[None]
    apart -= np.where(box.boundary[:, 0] == PERIODIC, box.lengths, 0.0) * np.rint(apart / box.lengths)
    distance = np.sqrt((apart**2).sum(axis=-1))
    between = distance / (radii[fixed:, None] + radii)
    to_fixed = (distance - radii) / radii[fixed:, None]
    ratio = np.where(np.arange(len(radii)) < fixed, to_fixed, between)
    ratio[np.arange(len(ratio)), np.arange(fixed, len(radii))] = np.inf
    return ratio.min(initial=np.inf)


class Trial(NamedTuple):
    """A trial body, the number of groups of the others, and the trials in each configuration."""

    radius: float
    mass: float
    side: int
    groups: int
    trials: int


@njit(cache=True)
def insert(sample, fixed, trial, box, seed):
    """Return mean weights exp(-u / kT) of a trial body in each configuration, 0 where it overlaps.

    Columns: in the volume (times the volume), on each face (times its area), in contact with all bodies of
    each group (times the surface of contact), and with the fixed ones (last).
    """
    np.random.seed(seed)
    d = len(box.lengths)
    found = np.zeros((len(sample.numbers), 1 + 2 * d + trial.groups + 1))
    x, box_lengths, plane = np.empty(d), box.lengths, box.plane
    for c in range(len(sample.numbers)):
        if plane[0] >= 0.0:
            plane[0] = sample.places[c]
        else:
            box_lengths[box.axis] = sample.places[c]
        volume = box_lengths.prod()
        others = sample.positions[c, : sample.numbers[c]]
        for _ in range(trial.trials):
            for f in range(1 + 2 * d):
                k, s = (f - 1) // 2, (f - 1) % 2
                if f > 0 and box.boundary[k, s] == PERIODIC:
                    continue
                for q in range(d):
                    x[q] = np.random.random() * box_lengths[q]
                if f > 0:
                    edge = box.margin * trial.radius if box.boundary[k, s] == WALL else 0.0
                    x[k] = box_lengths[k] - edge if s else edge
                energy = potential(x, trial.radius, trial.mass, trial.side, box)
                if energy < np.inf and not overlaps(x, trial.radius, others, sample.radii, -1, box):
                    size = volume if f == 0 else volume / box_lengths[k]
                    found[c, f] += math.exp(-energy / box.temperature) * size / trial.trials
        for j in range(len(others)):
            distance = trial.radius + sample.radii[j]
            direction = np.random.standard_normal(d)
            direction *= distance / math.sqrt((direction * direction).sum())
            for k in range(d):
                x[k] = others[j, k] + direction[k]
                if box.boundary[k, 0] == PERIODIC:
                    x[k] -= box_lengths[k] * math.floor(x[k] / box_lengths[k])
            energy = potential(x, trial.radius, trial.mass, trial.side, box)
            if energy < np.inf and not overlaps(x, trial.radius, others, sample.radii, j, box):
                surface = 2.0 * math.pi * distance if d == 2 else 4.0 * math.pi * distance**2
                column = 1 + 2 * d + (sample.groups[j] if j >= fixed else trial.groups)
                found[c, column] += math.exp(-energy / box.temperature) * surface
    return found


def inserted(case, kept, group, trials, seed):
    """Return the weights of trial bodies of a group in kept configurations: see `insert`."""
    box = case.box._replace(lengths=case.box.lengths.copy(), plane=case.box.plane.copy())
    one = case.groups[group]
    trial = Trial(one.radius, one.mass, one.side, len(case.groups), trials)
    return insert(kept, len(case.fixed), trial, box, seed)


def block_mean(above, below=None):
    """Return the mean of a series, or of a ratio of two, and its jackknife error from blocks."""
    a = np.array([part.mean(axis=0) for part in np.array_split(above, BLOCKS)])
    b = np.ones(BLOCKS)
    if below is not None:
        b = np.array([part.mean(axis=0) for part in np.array_split(below, BLOCKS)])
    b = b.reshape(b.shape + (1,) * (a.ndim - b.ndim))
    with np.errstate(all="ignore"):
        without = (a.sum(axis=0) - a) / (b.sum(axis=0) - b)
        error = np.sqrt((BLOCKS - 1) / BLOCKS * ((without - without.mean(axis=0)) ** 2).sum(axis=0))
        return a.sum(axis=0) / b.sum(axis=0), error
