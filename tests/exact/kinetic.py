"""Closed forms of the gases of kinetic equations in a box with gravity.

Bodies do not exclude each other: places are independent, and the density is a product over the axes. The
Enskog equation multiplies the rates by contact values at the packing fraction of a uniform gas.
"""

import itertools
import math

import numpy as np
from exact import closed, static
from exact.bodies import PERIODIC

POINTS = 4001
"""Points of an integral over an axis."""
RARE = 1e-5
"""Part of the largest force that few hits give, which a run need not see."""


class Independent:
    """Independent places of the groups of a case: share(n, axis, edges), at(n, axis, x), overlap(n, m)."""

    def __init__(self, kind):
        self.case, self.kind = kind.case, kind
        case, sizes = self.case, np.array([group.radius for group in kind.case.groups])
        margin = case.box.margin * sizes[:, None] * (case.box.boundary[:, 0] != PERIODIC)
        self.low, self.high = margin, case.box.lengths - margin
        masses = np.array([group.mass for group in case.groups])
        pull = np.where(case.periodic, 0.0, case.box.gravity)
        self.slope = masses[:, None] * pull / kind.temperature
        self.numbers = np.array([float(group.count) for group in case.groups])
        if case.activity:
            self.numbers = case.activity * (self.high - self.low).prod(axis=1)

    def below(self, n, axis, x):
        """Return the part of group n below x along an axis."""
        low, high, slope = self.low[n, axis], self.high[n, axis], self.slope[n, axis]
        x = np.clip(x, low, high)
        if not slope:
            return (x - low) / (high - low)
        return np.expm1(slope * (x - low)) / math.expm1(slope * (high - low))

    def at(self, n, axis, x):
        """Return the density of group n at x along an axis, of one body."""
        low, high, slope = self.low[n, axis], self.high[n, axis], self.slope[n, axis]
        if not slope:
            return np.full_like(x, 1.0 / (high - low))
        return slope * np.exp(slope * (x - low)) / math.expm1(slope * (high - low))

    def overlap(self, n, m):
        """Return the integral of the product of the densities of two groups, of one body each."""
        value = 1.0
        for k in range(self.case.dimension):
            low, high = max(self.low[n, k], self.low[m, k]), min(self.high[n, k], self.high[m, k])
            x = np.linspace(low, high, POINTS)
            value *= float(np.trapezoid(self.at(n, k, x) * self.at(m, k, x), x))
        return value

    def contact(self, n, m):
        """Return the factor of the rate of a pair."""
        if self.kind.equation == "boltzmann":
            return 1.0
        case, d = self.case, self.case.dimension
        ball = math.pi if d == 2 else 4.0 / 3.0 * math.pi
        radii, volume = np.array([group.radius for group in case.groups]), case.box.lengths.prod()
        moments = [ball * float((self.numbers * radii**power).sum()) / volume for power in (d, d - 1)]
        return closed.enskog_contact(d, moments, radii[n], radii[m])

    def pairs(self, n, m):
        """Return the pairs of two groups per distance at contact."""
        one, mate = self.case.groups[n], self.case.groups[m]
        number = self.numbers[n] * (self.numbers[m] if n != m else (self.numbers[n] - 1.0) / 2.0)
        around = static.sphere(self.case.dimension, one.radius + mate.radius)
        return number * self.overlap(n, m) * around * self.contact(n, m)


def density(kind):
    """Return the density along each axis, of all and of each group, in the bins of the sampler."""
    from exact.values import BINS

    gas, found = Independent(kind), {}
    for k, axis in enumerate("xyz"[: kind.dimension]):
        edges = np.linspace(0.0, kind.case.box.lengths[k], BINS + 1)
        volume = kind.case.box.lengths.prod() / BINS
        parts = [gas.numbers[n] * np.diff(gas.below(n, k, edges)) / volume for n in range(len(gas.numbers))]
        found[f"axis={axis}"] = _curve(sum(parts))
        if len(parts) > 1:
            found |= {f"axis={axis},species={n}": _curve(part) for n, part in enumerate(parts)}
    return found


def _curve(values):
    return {"values": values, "errors": 0.0 * values}


def forces(kind):
    """Return the force on each face, and the pressure: the sum over groups of force over area."""
    gas, force, pressure = Independent(kind), {}, {}
    for face, (k, s) in kind.case.walls.items():
        force[face], pressure[face] = [0.0, 0.0], [0.0, 0.0]
        for n, number in enumerate(gas.numbers):
            place = np.array([gas.high[n, k] if s else gas.low[n, k]])
            part = kind.temperature * number * float(gas.at(n, k, place)[0])
            force[face][0] += part
            pressure[face][0] += part / float(np.delete(gas.high[n] - gas.low[n], k).prod())
    for values in (force, pressure):
        rare = RARE * max((value for value, _ in values.values()), default=0.0)
        values |= {face: [value, rare] for face, (value, _) in values.items()}
    return force, pressure


def collision_rate(kind):
    """Return the collisions of a body per time."""
    gas, total, groups = Independent(kind), 0.0, kind.case.groups
    for n, m in itertools.combinations_with_replacement(range(len(groups)), 2):
        inverse = 1.0 / groups[n].mass + 1.0 / groups[m].mass
        speed = math.sqrt(kind.temperature * inverse / (2.0 * math.pi)) * closed.speed_factor(kind.freedoms)
        total += 2.0 * speed * gas.pairs(n, m)
    return {"": [total / kind.case.count, 0.0]}


def pair_rates(kind):
    """Return the collisions of a body of the first group of each pair per time with the second."""
    gas, groups, found = Independent(kind), kind.case.groups, {}
    for n, m in itertools.combinations_with_replacement(range(len(groups)), 2):
        inverse = 1.0 / groups[n].mass + 1.0 / groups[m].mass
        speed = math.sqrt(kind.temperature * inverse / (2.0 * math.pi)) * closed.speed_factor(kind.freedoms)
        each = (2.0 if n == m else 1.0) * speed / groups[n].count
        found[f"{n}-{m}"] = [each * gas.pairs(n, m), 0.0]
    return found


def contact_values(kind):
    """Return the contact value of each pair of groups."""
    pairs = itertools.combinations_with_replacement(range(len(kind.case.groups)), 2)
    return {f"{n}-{m}": [Independent(kind).contact(n, m), 0.0] for n, m in pairs}


def compressibility(kind):
    """Return Z by the virial of pairs at contact; 1 of the Boltzmann equation."""
    if kind.equation == "boltzmann":
        return {"": [1.0, 0.0]}
    gas, groups = Independent(kind), kind.case.groups
    pairs = itertools.combinations_with_replacement(range(len(groups)), 2)
    virial = sum(gas.pairs(n, m) * (groups[n].radius + groups[m].radius) for n, m in pairs)
    return {"": [1.0 + virial / (kind.dimension * kind.case.count), 0.0]}


def number(kind):
    """Return the mean number between open faces: that of an ideal gas."""
    return {"": [float(Independent(kind).numbers.sum()), 0.0]}


RULES = {
    "density": density,
    "force": lambda kind: forces(kind)[0],
    "pressure": lambda kind: forces(kind)[1],
    "collision_rate": collision_rate,
    "pair_rates": pair_rates,
    "contact_values": contact_values,
    "Z": compressibility,
    "number": number,
}
"""Observables whose values differ from those of the exact gas."""
