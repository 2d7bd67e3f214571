"""The kinds of scenes of the table of exact values: what each contains, found without gaspart."""

import math
from functools import cache, cached_property
from pathlib import Path

import yaml
from exact.bodies import Case

FILE = Path(__file__).with_name("scenes.yaml")
FREE = 1e-3
"""Largest radius of points, which never meet during a run."""


class Kind:
    """A kind of scene and its run."""

    def __init__(self, name, scene, run):
        self.name, self.scene, self.run = name, scene, run
        self.faces = scene.get("faces") or {}
        self.equation = "exact"

    def under(self, equation):
        """Return the kind of a gas that obeys an equation: "exact", "boltzmann" or "enskog"."""
        other = Kind(self.name, self.scene, self.run)
        other.equation = equation
        return other

    @cached_property
    def case(self):
        """The scene as the sampler reads it."""
        return Case(self.scene)

    @property
    def dimension(self):
        """Dimension of space."""
        return self.case.dimension

    @property
    def species(self):
        """Species of the scene file."""
        return self.scene.get("species") or []

    @property
    def law(self):
        """Restitution of the scene file."""
        return self.scene.get("restitution") or {}

    @property
    def temperature(self):
        """k_B T, of the faces if they have one; of a single body of fixed speed that of its energy."""
        first = self.species[0]
        if "speed" in first:
            return first["speed"] ** 2 / self.dimension
        return self.case.box.temperature

    @property
    def thermal_faces(self):
        """Names of faces that have a temperature, without open ones."""
        return [n for n, face in self.faces.items() if "temperature" in face and face["kind"] != "open"]

    @property
    def open_faces(self):
        """Names of open faces."""
        return [name for name, face in self.faces.items() if face["kind"] == "open"]

    @property
    def dragging(self):
        """Names of faces that change velocities along themselves: all walls, of rough bodies."""
        if self.rough:
            return [name.replace(" ", "_") for name in self.case.walls]
        found = (name for name, face in self.faces.items() if "temperature" in face)
        return [name for name in found if self.faces[name].get("components") != "normal"]

    @property
    def exchanges(self):
        """True if faces or walls exchange energy with the gas."""
        return bool(self.thermal_faces) or self.opened or self.warm_walls

    @property
    def sliding(self):
        """True if a thermal face slides."""
        return any(any(face.get("velocity") or ()) for face in self.faces.values())

    @property
    def opened(self):
        """True if a face is open."""
        return any(face["kind"] == "open" for face in self.faces.values())

    @property
    def sheared(self):
        """True if images slide (Lees and Edwards)."""
        return any(face["kind"] == "lees_edwards" for face in self.faces.values())

    @property
    def dissipates(self):
        """True if contacts lose energy."""
        return self.law.get("normal", 1.0) < 1.0 or -1.0 < self.law.get("tangential", -1.0) < 1.0

    @property
    def rough(self):
        """True if bodies have spins."""
        return self.law.get("tangential", -1.0) > -1.0

    @property
    def singles(self):
        """True if there are bodies of no species."""
        return bool(self.scene.get("particles"))

    @property
    def many_sizes(self):
        """True if radii differ within a species."""
        return any("polydispersity" in one for one in self.species)

    @property
    def driven(self):
        """True if a force acts along the walls."""
        pulls = zip(self.scene.get("gravity") or (), self.case.periodic, strict=False)
        return any(pull and around for pull, around in pulls)

    @property
    def falls(self):
        """True if gravity or a well acts."""
        return any(self.scene.get("gravity") or ()) or bool(self.case.box.wells.any())

    @property
    def moving_face(self):
        """True if a face or an interior wall moves."""
        moves = any(face["kind"] in ("piston", "vibrating") for face in self.faces.values())
        return moves or self.case.box.plane[0] >= 0.0

    @property
    def points(self):
        """True if bodies never meet: points, or a single body with nothing inside."""
        small = all(group.radius < FREE for group in self.case.groups)
        return small or (self.case.count == 1 and self.case.empty)

    @property
    def dilute(self):
        """True if the volume of the bodies is negligible, within 0.1 %."""
        ball = math.pi if self.dimension == 2 else 4.0 / 3.0 * math.pi
        filled = sum(one.count * one.radius**self.dimension for one in self.case.groups) * ball
        return filled < 1e-3 * self.case.box.lengths.prod()

    @property
    def wide(self):
        """True if a container is so many diameters wide that waves down to a diameter are too many."""
        largest = 2.0 * max(group.radius for group in self.case.groups)
        return bool((self.case.box.lengths / largest).prod() > 1e5) and not self.points

    @property
    def packed(self):
        """Packing fraction of the moving bodies, as a part of close packing."""
        filled = sum(group.count * group.radius**self.dimension for group in self.case.groups)
        close = {2: math.sqrt(12.0), 3: math.sqrt(32.0)}[self.dimension]
        return close * filled / float(self.case.box.lengths.prod())

    @property
    def solid(self):
        """True for a crystal, in which each body stays in its place."""
        return self.packed > 0.9

    @property
    def integrable(self):
        """True if each body keeps its speed for ever, so that means over time are those of its start."""
        return self.points and not self.exchanges

    @property
    def equilibrium(self):
        """True if the scene has a static distribution: nothing flows, heats or loses energy."""
        ramps = any(isinstance(f.get("temperature"), dict) for f in self.faces.values())
        ends = {(str(f.get("temperature")), tuple(f.get("velocity") or ()), f.get("activity"))
                for f in self.faces.values() if "temperature" in f}  # fmt: skip
        worked = self.works or ramps or "thermostat" in self.scene
        return not (self.sheared or self.dissipates or self.driven or worked or len(ends) > 1)

    @property
    def works(self):
        """True if a face works on the gas: it moves by itself, or holds bodies."""
        return any(f["kind"] in ("sticky", "vibrating") or "speed" in f for f in self.faces.values())

    @property
    def warm_walls(self):
        """True if an interior wall has a temperature."""
        return any("temperature" in wall for wall in self.scene.get("walls") or [])

    @property
    def conserved(self):
        """Number of components of the total momentum that are conserved."""
        if not self.case.empty:
            return 0
        if self.thermal_faces or self.opened or (self.rough and not self.case.periodic.all()):
            return 0
        return int(self.case.periodic.sum())

    @property
    def freedoms(self):
        """Degrees of freedom of fixed energy, None if faces exchange it."""
        if self.exchanges:
            return None
        return self.dimension * self.case.count - self.conserved

    @property
    def stress(self):
        """True if a run keeps correlations of the stress: periodic, with nothing inside."""
        return bool(self.case.periodic.all()) and self.case.empty and not self.falls


@cache
def kinds():
    """Return all kinds of scenes, by name."""
    with FILE.open(encoding="utf-8") as file:
        return {name: Kind(name, **entry) for name, entry in yaml.safe_load(file).items()}
