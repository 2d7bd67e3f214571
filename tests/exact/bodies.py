"""Scene files as arrays for the sampler, read without gaspart: containers, hard bodies, fields and faces."""

import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy import special

WALL, PERIODIC, OPEN = 0, 1, 2


class Box(NamedTuple):
    """All that acts on one body; numba compiles it. axis: along which a piston or a wall between two gases
    moves; plane: place (1,) of that wall, negative without one."""

    lengths: np.ndarray
    boundary: np.ndarray
    gravity: np.ndarray
    wells: np.ndarray
    plates: np.ndarray
    margin: float
    temperature: float
    axis: int
    plane: np.ndarray


class Group(NamedTuple):
    """Equal moving bodies. side: of the wall between two gases, -1 or 1; 0 without one."""

    count: int
    radius: float
    mass: float
    side: int


class Case:
    """A scene, parsed from YAML, as the sampler needs it.

    radii: of all moving bodies, if they differ within a species; load: force of a loaded piston, or 0;
    activity: per volume, 0 without open faces; drawn: fixed bodies at places that a run draws.
    """

    def __init__(self, scene):
        lengths = np.array(scene["container"]["lengths"], float)
        self.dimension = d = len(lengths)
        boundary = scene["container"].get("boundary", "wall")
        names = [boundary] * d if isinstance(boundary, str) else boundary
        kinds = np.array([[PERIODIC if name == "periodic" else WALL] * 2 for name in names])
        self.load, self.activity = 0.0, 0.0
        temperature, axis, wells = 1.0, 0, np.zeros((d, 2, 2))
        for name, face in (scene.get("faces") or {}).items():
            k, side = "xyz".index(name[0]), int(name.endswith("high"))
            if not isinstance(face.get("temperature"), dict):
                temperature = float(face.get("temperature", temperature))
            if face["kind"] == "open":
                kinds[k, side], self.activity = OPEN, face["activity"]
            elif face["kind"] == "well":
                wells[k, side] = face["depth"], face["width"]
            elif face["kind"] == "piston":
                axis, self.pressure = k, face.get("pressure", 0.0)
        margin = 0.0 if scene.get("centres_to_walls") else 1.0
        plane, plates = np.array([-1.0]), []
        for wall in scene.get("walls") or []:
            edges = wall["edges"] if d == 3 else [np.subtract(wall["end"], wall["start"]), [0.0, 0.0]]
            corner = wall["corner"] if d == 3 else wall["start"]
            if "mass" in wall:
                axis = int(np.argmin(np.abs(edges).max(axis=0)))
                plane[0] = corner[axis]
            else:
                plates.append([corner, *edges])
        shifts = itertools.product(*[(-1, 0, 1) if kind[0] == PERIODIC else (0,) for kind in kinds])
        images = [[np.add(one[0], np.multiply(s, lengths)), one[1], one[2]] for s in shifts for one in plates]
        plates = np.array(images, float).reshape(-1, 3, d)
        gravity = np.array(scene.get("gravity") or [0.0] * d, float)
        self.box = Box(lengths, kinds, gravity, wells, plates, margin, temperature, axis, plane)
        self._add_bodies(scene)
        self.radii = None
        if any("polydispersity" in one for one in scene["species"]):
            self.radii = np.concatenate([_radii(one) for one in scene["species"]])
        if "piston" in {face["kind"] for face in (scene.get("faces") or {}).values()}:
            self.load = self.pressure * float(np.delete(lengths, axis).prod())
        if self.activity:
            self.activity /= self.groups[0].radius ** d * (math.pi if d == 2 else 4.0 / 3.0 * math.pi)

    def _add_bodies(self, scene):
        """Add the bodies: species, then single ones; fixed ones apart."""
        d, axis, plane = self.dimension, self.box.axis, self.box.plane[0]
        still, self.groups, self.drawn = [], [], 0
        listed = [
            *(scene.get("species") or []),
            *(scene.get("particles") or []),
        ]
        for one in listed:
            if one.get("fixed") and "count" in one:
                self.drawn += one["count"]
                continue
            if one.get("fixed"):
                still.append((one["position"], one["radius"]))
                continue
            side = 0
            if plane >= 0.0:
                side = -1 if one["region"][1][axis] <= plane else 1
            self.groups.append(Group(one.get("count", 1), one["radius"], one.get("mass", 1.0), side))
        self.fixed = np.array([place for place, _ in still], float).reshape(-1, d)
        self.fixed_radii = np.array([radius for _, radius in still], float)

    @property
    def counts(self):
        """Number of bodies of each moving group."""
        return [group.count for group in self.groups]

    @property
    def count(self):
        """Number of moving bodies."""
        return sum(self.counts)

    @property
    def periodic(self):
        """True for each axis that is periodic, shape (d,)."""
        return self.box.boundary[:, 0] == PERIODIC

    @property
    def empty(self):
        """True if neither fixed bodies nor interior walls are inside."""
        return not len(self.fixed) and not self.drawn and not len(self.box.plates) and self.box.plane[0] < 0.0

    @property
    def walls(self):
        """Names of the hard faces and their columns (axis, side)."""
        found = itertools.product(range(self.dimension), (0, 1))
        return {
            f"{'xyz'[k]} {('low', 'high')[s]}": (k, s)
            for k, s in found
            if self.box.boundary[k, s] != PERIODIC
        }

    def bodies(self, less=None):
        """Radii, masses, groups and sides of the moving bodies, one of group `less` fewer."""
        numbers = [count - (n == less) for n, count in enumerate(self.counts)]
        radii = self.radii
        if radii is None:
            radii = np.repeat([group.radius for group in self.groups], numbers)
        masses = np.repeat([group.mass for group in self.groups], numbers)
        sides = np.repeat([group.side for group in self.groups], numbers)
        return np.array(radii, float), masses, np.repeat(np.arange(len(numbers)), numbers), sides


def _radii(species):
    """Return the radii of a species: quantiles at equally spaced probabilities, scaled to their mean."""
    count, spread = species["count"], species.get("polydispersity", 0.0)
    p = (np.arange(count)[::-1] + 0.5) / count
    if species.get("radius_distribution", "lognormal") == "uniform":
        radii = 1.0 + math.sqrt(3.0) * spread * (2.0 * p - 1.0)
    else:
        radii = np.exp(math.sqrt(math.log1p(spread**2)) * special.ndtri(p))
    return radii * species["radius"] / radii.mean()
