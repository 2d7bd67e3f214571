"""Appearance of faces and of thermal walls in all pictures.

A hard wall at rest is a thin dark line. A thermal surface is a thick line, with a colour from blue (the
coldest in the scene) to red (the hottest); it is orange if all have the same temperature. The line is dashed
if the surface thermalises only some of the velocities. An open face is dashed, with arrows for particles that
leave and enter. A moving surface has hatching, and an arrow in the direction of its motion; the arrow has two
heads if the surface moves to and fro. Behind a piston the container is shaded. Faces whose images slide are
dashed, with an arrow. A sticky face is green. The edge of a well is dotted.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gaspart.scene.faces import FLOW, GRADIENT, LeesEdwards, Open, Piston, Vibrating
from gaspart.scene.scene import Scene
from gaspart.scene.surfaces import Sticky, Surface, Thermal, Well

Colour = tuple[float, float, float]
INK: Colour = (0.16, 0.16, 0.16)
_COLD, _MIDDLE, _HOT = (0.15, 0.38, 0.80), (0.95, 0.55, 0.10), (0.80, 0.10, 0.12)
_OPEN, _STICKY, _WELL = (0.10, 0.50, 0.55), (0.15, 0.55, 0.20), (0.45, 0.25, 0.65)
_PIECES = 24
"""Number of pieces, of one colour each, of a face whose temperature varies along it."""


@dataclass(frozen=True)
class DrawnSurface:
    """Look of a face or of a wall in a picture."""

    ends: np.ndarray
    inward: np.ndarray
    colours: np.ndarray
    text: str
    dashed: bool = False
    hatched: bool = False
    motion: np.ndarray | None = None
    to_and_fro: bool = False
    through: tuple[int, ...] = ()
    depth: float = 0.0
    band: float = 0.0


def surfaces_of(scene: Scene, time: float = 0.0, piston: float | None = None) -> tuple[DrawnSurface, ...]:
    """Return the appearance of all surfaces except hard walls at rest."""
    lengths = np.array(scene.container.lengths)
    drawn = []
    for name, face in scene.faces.items():
        if isinstance(face, LeesEdwards):
            drawn += _sliding_images(face, lengths)
            continue
        axis, upper = "xyz".index(name[0]), "high" in name
        side = float(lengths[axis]) if upper else 0.0
        position = side
        if isinstance(face, Vibrating):
            inwards = float(face.places(np.array(time)))
            position = side - inwards if upper else inwards
        elif isinstance(face, Piston) and piston is not None:
            position = float(piston)
        inward = np.eye(scene.dimension)[axis] * (-1.0 if upper else 1.0)
        look = _look_of(face, scene, inward)
        text = f"{name.replace('_', ' ')}: {look.pop('text')}"
        drawn.append(
            DrawnSurface(
                _outline(lengths, axis, position), inward, text=text, depth=abs(position - side), **look
            )
        )
    return (*drawn, *_warm_walls(scene), *_moving_walls(scene, piston))


def _look_of(face: Surface, scene: Scene, inward: np.ndarray) -> dict[str, Any]:
    """Return the attributes of a face's appearance that depend on its kind."""
    if isinstance(face, Open):
        activity = face.activity
        text = "open, to a vacuum" if not activity else f"open, activity {activity:.3g}"
        return {
            "text": text,
            "colours": _one(_OPEN),
            "dashed": True,
            "through": (-1, 1) if activity else (-1,),
        }
    if isinstance(face, Piston):
        stated = ", ".join(f"{key} {value:.3g}" for key, value in vars(face).items() if value is not None)
        return {"text": f"piston, {stated}", "colours": _one(INK), "hatched": True, "motion": inward}
    if isinstance(face, Vibrating):
        text = f"vibrates, amplitude {face.amplitude:.3g}, period {face.period:.3g}"
        return {"text": text, "colours": _one(INK), "hatched": True, "motion": inward, "to_and_fro": True}
    if isinstance(face, Sticky):
        return {"text": f"sticky below momentum {face.momentum:.3g}", "colours": _one(_STICKY)}
    if isinstance(face, Well):
        text = f"well of depth {face.depth:.3g}"
        if face.temperature is not None:
            text += f", T = {face.temperature:.3g}"
        colours = _one(_WELL) if face.temperature is None else _one(colour_of(face.temperature, scene))
        return {"text": text, "colours": colours, "band": float(face.width)}
    assert isinstance(face, Thermal)
    return _thermal_look(face, scene)


def _thermal_look(face: Thermal, scene: Scene) -> dict[str, Any]:
    """Return the appearance of a thermal face: temperature, accommodation, motion."""
    low, high = face.temperatures[0], face.temperatures[-1]
    text = f"T = {low:.3g}" if low == high else f"T = {low:.3g} to {high:.3g}"
    temperatures = np.linspace(low, high, 1 if low == high else _PIECES)
    look: dict[str, Any] = {
        "colours": np.array([colour_of(float(temperature), scene) for temperature in temperatures])
    }
    if face.accommodation is not None:
        text += f", accommodation {face.accommodation:.3g}"
        look["dashed"] = True
    if face.slides:
        velocity = np.array(face.velocity)
        speed = float(np.linalg.norm(velocity))
        look |= {"hatched": True, "motion": velocity / speed}
        text += f", slides at {speed:.3g}"
    return look | {"text": text}


def _warm_walls(scene: Scene) -> tuple[DrawnSurface, ...]:
    """Return the appearance of interior walls at a temperature."""
    drawn = []
    for wall in scene.walls:
        if wall.temperature is None:
            continue
        corners = list(wall.corners.values())
        around = corners if len(corners) == 2 else [corners[0], corners[1], corners[3], corners[2]]
        colours, text = _one(colour_of(wall.temperature, scene)), f"wall: T = {wall.temperature:.3g}"
        drawn.append(DrawnSurface(np.array(around, float), np.zeros(scene.dimension), colours, text))
    return tuple(drawn)


def _moving_walls(scene: Scene, position: float | None) -> tuple[DrawnSurface, ...]:
    """Return the appearance of the moving interior wall. The wall is drawn at the coordinate `position`; for
    None, at its initial coordinate.
    """
    wall = scene.moving_wall
    if wall is None:
        return ()
    ends = _outline(
        np.array(scene.container.lengths), wall.axis, wall.position if position is None else position
    )
    text = f"wall: mass {wall.mass:.3g}, moves freely"
    along, aside = np.eye(scene.dimension)[wall.axis], np.zeros(scene.dimension)
    return (DrawnSurface(ends, aside, _one(INK), text, hatched=True, motion=along, to_and_fro=True),)


def _sliding_images(face: LeesEdwards, lengths: np.ndarray) -> list[DrawnSurface]:
    """Return the appearance of the two sheared faces, beyond which images of the gas slide."""
    drawn = []
    for side, name, region in ((1.0, "high", "above"), (-1.0, "low", "below")):
        speed = side * face.shear_rate * lengths[GRADIENT]
        axes = np.eye(len(lengths))
        drawn.append(
            DrawnSurface(
                _outline(lengths, GRADIENT, lengths[GRADIENT] if side > 0.0 else 0.0),
                -side * axes[GRADIENT],
                _one(INK),
                f"y {name}: images {region} slide at {speed:.3g}",
                dashed=True,
                motion=np.sign(speed) * axes[FLOW] if speed else None,
            )
        )
    return drawn


def colour_of(temperature: float, scene: Scene) -> Colour:
    """Return the colour of a temperature, in the range of temperatures of the scene's surfaces."""
    low, high = min(scene.face_temperatures), max(scene.face_temperatures)
    if not high > low:
        return _MIDDLE
    part = (temperature - low) / (high - low)
    red, green, blue = (cold + part * (hot - cold) for cold, hot in zip(_COLD, _HOT, strict=True))
    return red, green, blue


def _one(colour: Colour) -> np.ndarray:
    return np.array([colour], dtype=float)


def _outline(lengths: np.ndarray, axis: int, position: float) -> np.ndarray:
    """Return the ends of a face in 2D, or the corners around it in 3D."""
    corners = {2: ((0,), (1,)), 3: ((0, 0), (1, 0), (1, 1), (0, 1))}[len(lengths)]
    return np.insert(np.array(corners) * np.delete(lengths, axis), axis, position, axis=1).astype(float)


def arrow_lines(tail: np.ndarray, head: np.ndarray, two_heads: bool) -> list[np.ndarray]:
    """Return the lines of an arrow's shaft and barbs, (2, 2) each."""
    lines = [np.array([tail, head])]
    for tip, back in ((head, 0.25 * (tail - head)), (tail, 0.25 * (head - tail)))[: 1 + two_heads]:
        barbs = [tip + back + sign * 0.6 * np.array([-back[1], back[0]]) for sign in (-1.0, 1.0)]
        lines += [np.array([barb, tip]) for barb in barbs]
    return lines
