"""Controls of a gas in a browser, and the scene for their values.

Scenes with different features need different kernels. A letter stands for each feature that controls switch
on and off: g gravity, r contacts that lose energy or turn particles, p a piston, w interior walls, t thermal
faces (which need no other kernels).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from gaspart.accuracy.scales import scales
from gaspart.scene.faces import Piston
from gaspart.scene.restitution import Restitution
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import FACES, Surface, Thermal

_WEIGHTS = 8.0
"""Largest gravity: energy of a fall through the container, in units of m v^2 of a particle."""
_HOTTEST = 4.0
"""Largest temperature of a wall, divided by the largest temperature of gas and walls at the start."""
_LOADS = 0.5, 1.0, 2.0, 4.0
"""Pressures on the piston, divided by the pressure of an ideal gas at the start."""
_HEAVY = 0.2
"""Mass of a piston with a load, divided by the mass of the gas."""
_UNMOVED = 1e60
"""Mass of a piston that is moved by hand: hits do not change its velocity."""
_NORMALS = 1.0, 0.99, 0.97, 0.95, 0.9, 0.85, 0.8, 0.7, 0.5
_TANGENTIALS = -1.0, -0.5, 0.0, 0.5, 1.0
_CONTACT = 0.01
"""Contact duration of grains without gravity, in times of flight over a diameter."""
_STEPS = 12
"""Number of steps of gravity and of temperatures."""

RULES = (
    ("gp", "", "a piston needs a gas without gravity"),
    ("rp", "", "a piston needs smooth elastic particles"),
    (
        "gr",
        "t",
        "under gravity grains come to rest, which a page does not recognise: give a wall a temperature",
    ),
)
"""Features that exclude each other unless there is another one, with the reason."""


@dataclass(frozen=True)
class Control:
    """A parameter of a scene that a page can change.

    name : name, also the key of its values.
    group : name of the controls whose values determine the same numbers.
    values : values from which it chooses.
    start : index of its value in the scene as it is given.
    flags : letter of the feature that each value needs, or "".
    """

    name: str
    group: str
    values: tuple[Any, ...]
    start: int
    flags: tuple[str, ...]


class Controls:
    """Controls of a scene, and the scene for their values."""

    def __init__(self, scene: Scene) -> None:
        self.scene, size = scene, scales(scene)
        self._mass = min((kind.mass for kind in scene.moving_kinds), default=1.0)
        self._temperature = max(size.thermal_speed**2 * self._mass, *scene.face_temperatures, 0.0)
        self._contact = _CONTACT * 2.0 * scene.smallest_radius / (size.thermal_speed or 1.0)
        controls = [
            self._gravity(size.thermal_speed),
            *self._law(),
            *self._faces(),
            self._piston(),
            self._walls(),
        ]
        self.all = [control for control in controls if control]

    def _gravity(self, speed: float) -> Control | None:
        scene, down = self.scene, -(self.scene.gravity or (0.0,))[-1]
        pulled = [0.0] * (scene.dimension - 1)
        if scene.container.periodic[-1] or scene.has_piston or down < 0.0:
            return None
        if scene.gravity and list(scene.gravity[:-1]) != pulled:
            return None
        strongest = max(_WEIGHTS * speed**2 / scene.container.lengths[-1], 2.0 * down)
        return self._steps("gravity", strongest, down, "g")

    def _law(self) -> Iterator[Control]:
        scene, law = self.scene, self.scene.restitution or Restitution()
        if scene.count > 1 and not scene.has_piston:
            normals = tuple(sorted({*_NORMALS, law.normal}, reverse=True))
            flags = tuple("r" if value < 1.0 else "" for value in normals)
            yield Control("restitution", "law", normals, normals.index(law.normal), flags)
            tangentials = tuple(sorted({*_TANGENTIALS, law.tangential}))
            flags = tuple("r" if value > -1.0 else "" for value in tangentials)
            yield Control("roughness", "law", tangentials, tangentials.index(law.tangential), flags)

    def _faces(self) -> Iterator[Control]:
        for name in self._walled:
            face = self.scene.faces.get(name)
            if face is None:
                yield self._steps(name, _HOTTEST * self._temperature, 0.0, "t")
            elif isinstance(face, Thermal) and face.varies_along is None:
                (level,) = face.temperatures
                values = three_digits(np.linspace(0.0, _HOTTEST * self._temperature, _STEPS + 1)[1:], level)
                yield Control(name, name, values, values.index(level), ("t",) * len(values))

    def _piston(self) -> Control | None:
        """Return the control of a piston: None, 0 if moved by hand, or its pressure."""
        scene = self.scene
        bound = scene.walls or scene.has_piston or scene.has_fixed or scene.container.periodic[0]
        if bound or "x_high" in scene.faces or self._temperature == 0.0:
            return None
        ideal = scene.count * self._temperature / scene.container.volume
        values = (None, 0.0, *three_digits(ideal * np.array(_LOADS)))
        return Control("piston", "piston", values, 0, ("", *["p"] * (len(values) - 1)))

    def _walls(self) -> Control | None:
        return Control("walls", "walls", (True, False), 0, ("w", "")) if self.scene.walls else None

    def _steps(self, name: str, most: float, value: float, flag: str) -> Control:
        values = three_digits(np.linspace(0.0, most, _STEPS + 1), value)
        return Control(name, name, values, values.index(value), tuple(flag if x else "" for x in values))

    @property
    def _walled(self) -> list[str]:
        return [FACES[2 * axis + side] for axis in self.scene.walled_axes for side in (0, 1)]

    @property
    def constant(self) -> str:
        """Letters of features that no control switches off."""
        scene, names = self.scene, {control.name for control in self.all}
        present = {
            "g": scene.gravity is not None and "gravity" not in names,
            "r": scene.has_fixed or (scene.restitution is not None and "restitution" not in names),
            "p": scene.has_piston,
            "t": any(name not in names for name in scene.faces),
        }
        return "".join(letter for letter, is_there in present.items() if is_there)

    def flags(self, settings: dict[str, Any]) -> str:
        """Return the letters of the features for values of all controls."""
        flags = (item.flags[item.values.index(settings[item.name])] for item in self.all)
        return "".join(sorted({*self.constant, *"".join(flags)}))

    def scene_for(self, settings: dict[str, Any], scene: Scene) -> Scene:
        """Return a scene with values of controls. Other controls have the values of the scene of the page.
        `scene`: the scene of the page, or this scene with another number of particles.
        """
        values = {control.name: control.values[control.start] for control in self.all} | settings
        faces: dict[str, Surface] = dict(scene.faces)
        for name in self._walled:
            if name in values:
                face, level = scene.faces.get(name), values[name]
                faces.pop(name, None)
                if level:
                    faces[name] = (
                        replace(face, temperature=level) if isinstance(face, Thermal) else Thermal(level)
                    )
        changes: dict[str, Any] = {}
        if values.get("piston") is not None:
            load = values["piston"]
            mass = _HEAVY * sum(kind.mass * getattr(kind, "count", 1) for kind in scene.kinds)
            faces["x_high"] = Piston(mass=mass if load else _UNMOVED, pressure=load)
        if "gravity" in values:
            pull = values["gravity"]
            changes["gravity"] = (*[0.0] * (scene.dimension - 1), -pull) if pull else None
        if "restitution" in values:
            law = replace(scene.restitution or Restitution(), normal=values["restitution"])
            law = replace(law, tangential=values["roughness"])
            if law.dissipative and law.contact_duration is None and not values.get("gravity", scene.gravity):
                law = replace(law, contact_duration=self._contact)  # otherwise a collapse would end the gas
            changes["restitution"] = law if law != Restitution() else None
        if not values.get("walls", True):
            changes["walls"] = ()
        return replace(scene, faces=faces, **changes)

    def kinds(self) -> list[str]:
        """Return the kinds of scenes that `RULES` allow: their letters, in order and without t."""
        letters = [{self.constant.replace("t", "")}]
        for group in dict.fromkeys(control.group for control in self.all):
            flags = {flag for control in self.all if control.group == group for flag in control.flags}
            letters.append(flags - {"t"} or {""})
        kinds = {"".join(sorted(set("".join(parts)))) for parts in product(*letters)}
        warm = "t" in self.constant or any(control.name in self._walled for control in self.all)
        return sorted(kind for kind in kinds if all(self._allows(kind, rule, warm) for rule in RULES))

    @staticmethod
    def _allows(kind: str, rule: tuple[str, str, str], warm: bool) -> bool:
        both, unless, _ = rule
        return not set(both) <= set(kind) or bool(unless and warm)

    def typical(self, kind: str) -> dict[str, Any]:
        """Return values of controls for a kind of scene with as many thermal faces as possible."""
        values: dict[str, Any] = {}
        for control in self.all:
            with_flag = [
                value
                for value, flag in zip(control.values, control.flags, strict=True)
                if flag in (*kind, "t") and flag
            ]
            without = [value for value, flag in zip(control.values, control.flags, strict=True) if not flag]
            values[control.name] = with_flag[-1] if with_flag else without[0]
        return values


def three_digits(values: np.ndarray, kept: float | None = None) -> tuple[float, ...]:
    """Return values with three digits in ascending order, and a value with all digits."""
    rounded = {float(f"{value:.3g}") for value in values}
    if kept is not None and kept not in rounded:
        rounded = {value for value in rounded if abs(value - kept) > 0.02 * max(rounded)} | {kept}
    return tuple(sorted(rounded))
