"""The sampled values of the table: `PYTHONPATH=tests python -m exact.values [KIND ...]` renews values.json.

It takes minutes of one core and is not run by the tests. Each kind of scene is stored with its recipe: seed,
configurations, sweeps between them, date. Errors are those of 20 blocks; see static.py for the definitions.
"""

import datetime
import json
import math
import sys
import time
from functools import cache
from pathlib import Path

import numpy as np
from exact import closed, static
from exact.kinds import kinds
from exact.sampler import block_mean, inserted, sample

FILE = Path(__file__).with_name("values.json")
SEED, CONFIGURATIONS, EVERY, TRIALS = 1, 12_000, 4, 16
FEW = 6
"""Bodies of scenes that get five times as many configurations, which are cheap."""
BINS, WAVE_BINS = 40, 30
SHELLS, REACH = 60, 0.499
"""Bins of g(r), up to this part of the shortest side."""
DENSE = ("discs_69", "discs_88")
"""Kinds in which no body can be inserted."""
LEFT = 0.02
"""Part of a bin that fixed bodies must leave, for a density there."""


@cache
def stored():
    """Return the stored values and recipes, by kind of scene."""
    return json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}


def computed(kind):
    """Return all sampled values of a kind of scene: observable -> part -> [value, error], or of curves a
    mapping of lists."""
    if not (kind.equilibrium or kind.points):
        return {}
    case = kind.case
    if case.drawn or {"crystal", "transport"} & set(kind.run):
        return {}
    number = CONFIGURATIONS * (8 if case.count < FEW else 1)
    found = {}
    if kind.name not in DENSE and case.radii is None and kind.equilibrium:
        values, errors = static.contacts(case, number, EVERY, TRIALS, SEED)
        found |= wall_values(kind, case, values, errors)
        found |= pair_values(kind, case, values, errors)
    kept = sample(case, CONFIGURATIONS, 6 if kind.name not in DENSE else 30, SEED + 11)
    if kind.equilibrium and (case.radii is not None or kind.name in DENSE):
        found |= values_of_gaps(kind, case, kept)
    found["density"] = densities(case, kept)
    if case.periodic.all() and case.empty and kind.equilibrium:
        found |= periodic_values(kind, case, kept)
    if case.activity:
        found["number"] = {"": block_mean(kept.numbers - len(case.fixed))}
    return found


def wall_values(kind, case, values, errors):
    """Return the force on each face, and the pressure: the sum over groups of force over area of centres."""
    force, pressure, t = {}, {}, case.box.temperature
    areas = [static.room(case, n)[0] for n in range(len(case.groups))]
    for face, (k, s) in case.walls.items():
        column = 1 + 2 * k + s
        if case.box.wells[:, :, 0].any() and case.box.wells[k, s, 0] > 0.0:
            column = 1 + 2 * k + 1 - s  # of the face and its step together: as on the opposite face
        parts = np.array([[t * values[n, column], t * errors[n, column]] for n in range(len(case.groups))])
        sizes = np.array([area[column] for area in areas])
        total = float(parts[:, 0].sum()), math.hypot(*parts[:, 1])
        weight = -case.box.gravity[k] * sum(one.count * one.mass for one in case.groups)
        if weight > 0.0 and s == 0:  # a floor carries the weight and what presses the ceiling
            above = values[:, column + 1] * t
            total = float(weight + above.sum()), math.hypot(*(t * errors[:, column + 1]))
            if len(case.groups) == 1:
                parts = np.array([total])
        force[face] = total
        reached = sizes > 0.0  # none is of a gas behind a wall
        parts, sizes = parts[reached], sizes[reached]
        pressure[face] = (parts[:, 0] / sizes).sum(), math.hypot(*(parts[:, 1] / sizes))
        if case.load and k == case.box.axis:  # both faces balance the load, by which the pressure is defined
            force[face], pressure[face] = (case.load, 0.0), (case.pressure, 0.0)
    if kind.moving_face:  # along the others, areas of the moment have no mean of their own
        across = [face for face in force if face[0] == "xyz"[case.box.axis]]
        force, pressure = ({face: one[face] for face in across} for one in (force, pressure))
    return {"force": force, "pressure": pressure}


def pair_values(kind, case, values, errors):
    """Return rates of collisions, contact values and Z, from pairs per distance at contact."""
    d, t, groups = case.dimension, kind.temperature, case.groups
    if case.activity:
        return {}
    rates, contact, total, scatter, virial, spread = {}, {}, 0.0, 0.0, 0.0, 0.0
    for a, one in enumerate(groups):
        for b in range(a, len(groups) + 1):
            pairs, error = values[a, 1 + 2 * d + b], errors[a, 1 + 2 * d + b]
            mate = groups[b] if b < len(groups) else None
            if mate and a < b and not error <= errors[b, 1 + 2 * d + a]:  # the smaller is easier to insert
                pairs, error = values[b, 1 + 2 * d + a], errors[b, 1 + 2 * d + a]
            if mate and one.side != mate.side:
                pairs = error = 0.0
            inverse = 1.0 / one.mass + (1.0 / mate.mass if mate else 0.0)
            speed = math.sqrt(t * inverse / (2.0 * math.pi)) * closed.speed_factor(kind.freedoms)
            share = (2.0 if mate else 1.0) * speed / case.count
            total, scatter = total + share * pairs, math.hypot(scatter, share * error)
            if not mate:
                continue
            each = (2.0 if a == b else 1.0) * speed / one.count
            if (a == b and one.count == 1) or one.side != mate.side:
                continue  # these never meet: their rate is NaN, as that of pairs without a collision
            rates[f"{a}-{b}"] = each * pairs, each * error
            sigma = one.radius + mate.radius
            virial, spread = virial + pairs * sigma, math.hypot(spread, error * sigma)
            number = one.count * mate.count if a != b else one.count * (one.count - 1) / 2.0
            if number:
                scale = case.box.lengths.prod() / (number * static.sphere(d, sigma))
                contact[f"{a}-{b}"] = scale * pairs, scale * error
    found = {"collision_rate": {"": (total, scatter)}, "pair_rates": rates}
    if case.periodic.all() and case.empty and case.count > 1:
        z = 1.0 + virial / (d * case.count), spread / (d * case.count)
        found |= {"Z": {"": z}, "contact_values": contact}
    return found


def values_of_gaps(kind, case, kept):
    """Return values of many sizes, or of bodies that cannot be inserted, from fits of gaps."""
    t, found = kind.temperature, {}
    if case.count > 1 and case.periodic.all():
        z, (pairs, error) = static.scaled_pairs(case, kept)
        found["Z"] = {"": z}
    elif case.count > 1:
        _, (pairs, error) = static.scaled_pairs(case, kept)
    share = 2.0 * math.sqrt(t / math.pi) * closed.speed_factor(kind.freedoms) / case.count
    found["collision_rate"] = {"": (share * pairs, share * error)}
    found["pair_rates"] = {"0-0": (share * pairs, share * error)}
    if case.walls:
        forces = static.forces_of_many(case, kept)
        found["force"] = {face: (t * one[0], t * one[1]) for face, (one, _) in forces.items()}
        found["pressure"] = {face: (t * one[0], t * one[1]) for face, (_, one) in forces.items()}
    elif case.radii is None:
        sigma = 2.0 * case.groups[0].radius
        number = case.count * (case.count - 1) / 2.0 * static.sphere(case.dimension, sigma)
        scale = case.box.lengths.prod() / number
        found["contact_values"] = {"0-0": (scale * pairs, scale * error)}
    return found


def densities(case, kept):
    """Return the density along each axis, of all and of each group: per volume that fixed bodies leave."""
    found, groups = {}, range(len(case.groups))
    for axis in range(case.dimension):
        share = [static.free_share(case, n, axis, BINS) if len(case.fixed) else np.ones(BINS) for n in groups]
        parts = []
        for n in groups:
            value, error = static.profile(case, kept, axis, BINS, n)
            known = share[n] >= LEFT
            part = np.where(known, share[n], np.nan)
            parts.append((value / part, error / part))
        name = f"axis={'xyz'[axis]}"
        whole = sum(value for value, _ in parts), np.sqrt(sum(error**2 for _, error in parts))
        found[name] = _curve(*whole)
        if len(parts) > 1:
            found |= {f"{name},species={n}": _curve(*part) for n, part in enumerate(parts)}
    return found


def periodic_values(kind, case, kept):
    """Return g(r), S(k), order and chemical potentials of a periodic container with nothing inside."""
    few = kept._replace(positions=kept.positions[:: max(1, len(kept.positions) // 4000)])
    largest = 2.0 * kept.radii.max()
    found = {}
    if case.count > 1:
        furthest = float(REACH * case.box.lengths.min())
        g, error = static.radial_distribution(case, few, furthest, SHELLS)
        found["rdf"] = {f"furthest={furthest!r},bins={SHELLS}": _curve(g, error)}
    if largest > 1e-3 and not kind.wide:
        highest = float(10.0 / largest)
        numbers, s, error = static.structure_factors(case, few, highest, WAVE_BINS)
        which = f"highest={highest!r},bins={WAVE_BINS}"
        pairs = [f"{a}-{b}" for a in range(len(case.groups)) for b in range(a, len(case.groups))]
        parts = {f"{which},{pair}": _curve(s[q], error[q], numbers) for q, pair in enumerate(pairs)}
        found |= {
            "partial_structure_factors": parts,
            "structure_factor": {which: _curve(s[-1], error[-1], numbers)},
        }
    if case.count >= (7 if case.dimension == 2 else 13):
        order = static.hexatic_order if case.dimension == 2 else static.steinhardt_order
        found["order"] = {"": block_mean(order(case, kept.positions[:: len(kept.positions) // 600]))}
    potentials = {}
    for n in range(len(case.groups)):
        if case.radii is not None:
            break
        value, error = block_mean(inserted(case, kept, n, 60, 3)[:, 0] / case.box.lengths.prod())
        if 0.0 < error < 0.2 * value:
            potentials[str(n)] = -math.log(value), error / value
    return found | ({"chemical_potential": potentials} if potentials else {})


def _curve(values, errors, at=None):
    curve = {"values": values, "errors": errors}
    return curve if at is None else curve | {"at": at}


def rounded(thing):
    """Return numbers with six digits, NaN as None, as JSON has them."""
    if isinstance(thing, dict):
        return {key: rounded(one) for key, one in thing.items()}
    if isinstance(thing, (list, tuple, np.ndarray)):
        return [rounded(one) for one in thing]
    return float(f"{thing:.6g}") if math.isfinite(thing) else None


def renew(names):
    """Sample the values of the named kinds, all by default, and write the file."""
    found = {name: entry for name, entry in stored().items() if name in kinds()}
    for name in names or kinds():
        kind, began = kinds()[name], time.process_time()
        values = rounded(computed(kind))
        seconds = time.process_time() - began
        recipe = {
            "scene": kind.scene, "seed": SEED, "configurations": CONFIGURATIONS, "every": EVERY,
            "trials": TRIALS, "date": datetime.date.today().isoformat(), "cpu_seconds": round(seconds, 1),
        }  # fmt: skip
        found[name] = {"recipe": recipe, "values": values}
        print(f"{name}: {seconds:.1f} s", flush=True)
        lines = [f"{json.dumps(key)}: {json.dumps(found[key])}" for key in kinds() if key in found]
        FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    renew(sys.argv[1:])
