"""Memory of the event-driven engine's kernels for a scene, as bytes for a WebAssembly module.

A page in a browser copies the image into the memory of the module, writes a state into it, and calls the
kernels. All numbers that depend on the scene are in the image. So a scene with another gravity or another
temperature of a wall differs from it in a few words, if its kernels have arguments of the same types.
"""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

import numpy as np

from gaspart.engines.event.dynamics import EventDynamics
from gaspart.engines.features.faces import FacesPart, PistonPart, special_faces
from gaspart.engines.features.law import DurationPart, RestWatch, lasting_contacts
from gaspart.errors import SceneError
from gaspart.kernels.compile.cache import load_numba
from gaspart.kernels.compile.webassembly import Kernels
from gaspart.kernels.event import loop, prediction
from gaspart.kernels.event.pair_contact import Monitors
from gaspart.kernels.obstacles import moving
from gaspart.kernels.physics import flight
from gaspart.scene.features import FEATURES
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import FACES
from gaspart.state.state import State

types: Any = load_numba().core.types

START = 1 << 18
"""Address of the image; the stack is below."""
_ALIGNED = 64
_REFUSED = (
    "thermostat",
    "moving_wall",
    "lees_edwards",
    "well",
    "sticky",
    "vibrating",
    "open",
    "vibrations",
    "viscoelasticity",
)
"""Features whose parts of a run are not in the kernels alone."""


def check_scene(scene: Scene) -> None:
    """Raise SceneError for a scene that cannot run in a browser."""
    for name in _REFUSED:
        if name in scene.features:
            raise FEATURES[name].refuse(scene, "is not available in a browser")


class _Arrays(EventDynamics):
    """Arrays of the kernels for a scene, without predictions of events; `_numbers` and `_image` read them."""

    def __init__(self, scene: Scene, state: State, seed: int) -> None:
        super().__init__(scene, state, seed, "boxes", None)
        # scenes share kernels, whether they have special faces and lasting contacts or not
        if self._model.faces is None:
            faces = special_faces(scene, state, seed, self._tally._unit_mass)
            self._model = self._model._replace(faces=faces)
        law = self._model.law
        if law and law.duration is None:
            duration = lasting_contacts(scene, law)
            law = law._replace(duration=duration)
            self._model = self._model._replace(law=law)
            self._parts.append(DurationPart(law, duration, self._model.gravity))
        for part in self._parts:
            if isinstance(part, RestWatch):
                rule = (
                    "lets grains rest under gravity, which a browser does not recognise without a driven face"
                )
                raise SceneError("restitution", scene.restitution, rule)

    def _predict(self) -> None:
        pass


@dataclass
class Image:
    """Bytes from `START` on, and the addresses of their contents.

    kernels : types of the kernels' arguments.
    words : address of the arguments of each kernel.
    slots : addresses of arguments that a page sets.
    arrays : address of each array that a page reads or writes.
    times : address and length of each array of times, which an epoch shifts.
    scaled : addresses of numbers proportional to the length of an epoch, which is 1 in the image.
    unit : unit of mass of impulses and energies.
    boxes : number and width of the boxes along each axis.
    """

    data: bytearray = field(default_factory=bytearray)
    kernels: Kernels = field(default_factory=dict)
    words: dict[str, int] = field(default_factory=dict)
    slots: dict[str, list[int]] = field(default_factory=dict)
    arrays: dict[str, int] = field(default_factory=dict)
    times: list[tuple[int, int]] = field(default_factory=list)
    scaled: list[int] = field(default_factory=list)
    unit: float = 1.0
    boxes: list[tuple[int, float]] = field(default_factory=list)
    _placed: dict[tuple, int] = field(default_factory=dict)

    def reserve(self, size: int) -> int:
        """Return the address of new zero bytes."""
        self.data += bytes(-len(self.data) % _ALIGNED)
        at = len(self.data)
        self.data += bytes(size)
        return START + at

    def write(self, at: int, content: bytes) -> None:
        """Write bytes at an address."""
        self.data[at - START : at - START + len(content)] = content

    def place(self, array: np.ndarray) -> int:
        """Return the address of an array, which is added if it is not there."""
        key = array.__array_interface__["data"][0], array.shape, array.strides
        if key not in self._placed:
            steps = zip(array.shape, array.strides, strict=True)
            size = sum((n - 1) * step for n, step in steps) + array.itemsize if array.size else 0
            self._placed[key] = self.reserve(size)
            self.write(self._placed[key], ctypes.string_at(key[0], size))
        return self._placed[key]

    def add_kernel(self, name: str, kernel: Any, arguments: tuple, set_later: dict[str, int]) -> None:
        """Add a kernel and its arguments; `set_later` has the position of arguments that a page sets."""
        kinds = tuple(kernel.typeof_pyval(argument) for argument in arguments)
        self.kernels[name] = kernel.py_func.__module__, kernel.py_func.__name__, kinds
        words = [_words(kind, value, self.place) for kind, value in zip(kinds, arguments, strict=True)]
        self.words[name] = self.reserve(8 * sum(map(len, words)))
        self.write(self.words[name], b"".join(chain(*words)))
        for argument, position in set_later.items():
            at = self.words[name] + 8 * sum(map(len, words[:position]))
            self.slots.setdefault(argument, []).append(at)


def _words(kind: Any, value: Any, address: Callable[[np.ndarray], int]) -> list[bytes]:
    """Return the words of eight bytes that numba passes for an argument."""
    if isinstance(kind, types.NoneType):
        return [bytes(8)]
    if isinstance(kind, types.BaseTuple):
        return list(chain(*(_words(k, v, address) for k, v in zip(kind, value, strict=True))))
    if isinstance(kind, types.Array):
        integers = 0, 0, value.size, value.itemsize, address(value), *value.shape, *value.strides
        return [struct.pack("<q", number) for number in integers]
    return [struct.pack("<d" if isinstance(kind, types.Float) else "<q", value)]


def image_of(scene: Scene, state: State, seed: int, scaled: bool = True) -> Image:
    """Return the image of a scene without positions and velocities; `scaled`: with these addresses."""
    check_scene(scene)
    arrays = _Arrays(scene, state, seed)
    arrays._flights["position"] = arrays._flights["velocity"] = 0.0
    arrays._particles.predictions["box"] = 0
    image = _image(arrays, 1.0)
    if scaled:
        words, doubled = (np.frombuffer(bytes(it.data), "<f8") for it in (image, _image(arrays, 2.0)))
        changed = np.flatnonzero(words.view("<i8") != doubled.view("<i8"))
        assert (2.0 * words[changed] == doubled[changed]).all()
        image.scaled = [START + 8 * n for n in changed.tolist()]
    return image


def _image(arrays: _Arrays, epoch: float) -> Image:
    arrays._begin_epoch(epoch)
    model, particles, flights = arrays._model, arrays._particles, arrays._flights
    tally = arrays._tally.arrays._replace(per_area=None)
    scene = particles, arrays._queue, arrays._boxes
    grid = zip(arrays._grid.per_side.tolist(), arrays._grid.widths.tolist(), strict=True)
    image = Image(unit=arrays._tally._unit_mass, boxes=list(grid)[: arrays._scene.dimension])
    flying = (flights, 0.0, model.space, model.gravity)
    monitors = Monitors(None, arrays._collapse.watch)
    run = *scene, model, tally, monitors, (0.0, 0, 0), None
    image.add_kernel("run", loop.run, run, {"limits": 6})
    begin = *scene, model._replace(masses=None, law=None), tally, 0.0, True
    image.add_kernel("begin", prediction.begin, begin, {"now": 5})
    image.add_kernel("restart", flight.restart_clocks, flying, {"time": 1})
    image.add_kernel("advance", flight.advance_all, flying, {"time": 1})
    listed = {"flights": flights, "images": particles.images, "predictions": particles.predictions}
    listed |= {name: getattr(tally, name) for name in ("counts", "sums", "wall_hits", "wall_impulse")}
    listed["numbers"] = _numbers(arrays)
    if piston := model.faces and model.faces.piston:
        image.add_kernel("piston", moving.advance_piston, (piston.motion, piston.push, 0.0), {"time": 2})
        listed["piston"] = piston.motion
    if model.law:
        listed["spins"] = model.law.spins
    image.arrays = {name: image.place(array) for name, array in listed.items()}
    image.arrays["out"] = image.reserve(2 * _ALIGNED)
    times = (array for part in arrays._parts for array in part._times)
    image.times = [(image.place(array), len(array)) for array in times]
    image.data += bytes(-len(image.data) % 8)
    return image


def _numbers(arrays: _Arrays) -> np.ndarray:
    """Return numbers of the scene that a page needs, as an array of the image. The first are the squares of
    the speeds that a particle gains: by gravity, by a piston, by interior walls and sliding faces, and by
    each face. The others are 1 if particles are rough, and if the speed of the piston is prescribed.
    """
    scene, numbers = arrays._scene, np.zeros(5 + 2 * arrays._scene.dimension)
    lightest = float(arrays._reference.masses.min(initial=np.inf))
    numbers[-2] = scene.rough
    for part in arrays._parts:
        if isinstance(part, PistonPart):
            numbers[1] = part.gained
            numbers[-1] = scene.pistons[0][1].speed is not None
        elif isinstance(part, FacesPart):
            temperatures = [
                max(scene.faces[name].temperatures, default=0.0) if name in scene.faces else 0.0
                for name in FACES[: 2 * scene.dimension]
            ]
            numbers[3:-2] = np.array(temperatures) * scene.dimension / lightest
            if scene.walls or scene.sliding_faces:
                numbers[2] = part.gained
        else:
            numbers[0] += part.gained
    return numbers
