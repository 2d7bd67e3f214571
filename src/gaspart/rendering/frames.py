"""Pictures of trajectories, simulations, states and scenes."""

from __future__ import annotations

import base64
import html
import io
import math
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from gaspart.errors import SceneError
from gaspart.keys.values import count_of
from gaspart.rendering.particles import DrawnParticles, Labels, colours_of, legend_of
from gaspart.rendering.pictures import SIZE, checked_camera, checked_size, picture, pixels_per_length
from gaspart.rendering.surfaces import surfaces_of
from gaspart.scene.faces import Piston, Vibrating
from gaspart.scene.scene import Scene
from gaspart.scene.walls import Wall
from gaspart.simulation import Simulation
from gaspart.state.initial import initial_state
from gaspart.state.insertion import per_particle
from gaspart.state.state import State
from gaspart.trajectory.reading import open_trajectory
from gaspart.yaml_text import parse_yaml

if TYPE_CHECKING:
    import xarray as xr


# Pictures and films in notebooks: they are arrays and paths that display themselves.


LARGEST_FILM = 50_000_000
"""Largest size of a film inside a notebook, in bytes; a larger film is a link."""


class Picture(np.ndarray):
    """Array of pixels, uint8 (H, W, 3), that a notebook shows as a picture. Slices and results of arithmetic
    that are not pictures are shown as arrays.
    """

    def _repr_png_(self) -> bytes | None:
        """Return the picture as a PNG file; None for arrays that are no pictures."""
        if self.dtype != np.uint8 or self.ndim != 3 or self.shape[2] != 3 or not self.size:
            return None
        from PIL import Image

        content = io.BytesIO()
        Image.fromarray(np.ascontiguousarray(self)).save(content, "PNG")
        return content.getvalue()

    def figure(self, caption: str) -> str:
        """Return the picture as HTML, with a line of text below it."""
        source = f"data:image/png;base64,{base64.b64encode(self._repr_png_() or b'').decode()}"
        text = html.escape(caption)
        image = f'<img src="{source}" alt="{text}" style="max-width: 100%">'
        return f'<figure style="margin: 0">{image}<figcaption>{text}</figcaption></figure>'


class Film(type(Path())):  # type: ignore[misc]
    """Path of a film, .mp4 or .gif, which a notebook shows."""

    def _repr_html_(self) -> str | None:
        """Return HTML with a film, or with a link to a large film, or None."""
        if not self.is_file():
            return None
        name = html.escape(str(self))
        if self.stat().st_size > LARGEST_FILM:
            return f'<a href="{name}">{name}</a>'
        content = base64.b64encode(self.read_bytes()).decode()
        if self.suffix == ".gif":
            return f'<img src="data:image/gif;base64,{content}" alt="{name}">'
        return f'<video src="data:video/mp4;base64,{content}" controls loop style="max-width: 100%"></video>'


Source: TypeAlias = "str | Path | xr.Dataset | Simulation | State | Scene"
"""Source of pictures: a trajectory, by its path or open, a simulation, a state or a scene."""
_CORNERS = {2: ((0,), (1,)), 3: ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))}
"""Corners of a face, in order along its outline, in a container of side 1."""


def render(
    source: Source,
    frame: int = -1,
    size: tuple[int, int] = SIZE,
    colour: str | np.ndarray = "speed",
    fastest: float | None = None,
    clock: bool = False,
    camera: tuple[float, float] | None = None,
) -> Picture:
    """Draw a frame of a trajectory, a simulation, a state or a scene.

    Spheres are drawn in perspective, with light and shadow, over the floor of the container (z = 0). Discs
    are drawn from above. At periodic faces they are cut, and the other part is drawn at the opposite side.
    Interior walls of a state are not drawn. The same particles give the same pixels.

    Parameters
    ----------
    source : str, Path, Dataset, Simulation, State or Scene
        A trajectory (its path, or an open trajectory), a simulation at the present time, a state, or a scene
        at time 0 (seed 0).
    frame : int, default -1
        Index of the frame of a trajectory, counted from 0, or from the end if negative.
    size : tuple of int, default (1000, 750)
        Width W and height H in pixels.
    colour : {"speed", "species"} or ndarray, shape (N, 3), default "speed"
        Colours of the particles. "speed": from dark at rest to bright at the speed `fastest` and above; fixed
        particles are grey. An array has red, green and blue from 0 to 1.
    fastest : float, [length/time], optional
        Speed of the brightest colour. Default: twice the root-mean-square speed.
    clock : bool, default False
        Write parameters and the meaning of the colours above the picture, and the time and a bar of a round
        length (for spheres: in the middle of the container) below.
    camera : tuple of float, optional
        Azimuth and elevation in degrees from which spheres are seen. Default: (298, 24).

    Returns
    -------
    Picture
        Array of uint8, shape (H, W, 3), which notebooks show as a picture.

    Raises
    ------
    SceneError
        If the frame does not exist, the size or the camera is impossible, the colouring is unknown, or the
        particles of a scene do not fit.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> gp.render(scene, size=(80, 60)).shape
    (60, 80, 3)
    """
    second: object = frame
    if isinstance(second, str | Path):
        raise SceneError("frame", str(second), "must be a number; render(source).save(path) writes the file")
    size = checked_size(size)
    with open_source(source) as opened:
        particles = particles_of(opened, frame)
        time = _time_of(opened, frame)
    direction = checked_camera(camera, particles.dimension)
    if not clock:
        colours = colours_of(particles, colour, fastest)
        return picture(particles, size, colours, direction=direction).view(Picture)
    labels = Labels(size, particles.parameters, legend_of(particles, colour, fastest), particles.surfaces)
    image = picture(particles, labels.inner, colours_of(particles, colour, fastest), direction=direction)
    scale = pixels_per_length(particles, labels.inner, direction)
    return labels.add_to(image, f"{time:.4g}", scale).view(Picture)


@contextmanager
def open_source(source: Source) -> Iterator[xr.Dataset | Simulation | State | Scene]:
    """Yield an open source; a trajectory given by its path is closed afterwards."""
    if isinstance(source, str | Path):
        with open_trajectory(source) as trajectory:
            yield trajectory
    else:
        yield source


def particles_of(source: State | Simulation | Scene | xr.Dataset, frame: int = -1) -> DrawnParticles:
    """Return the particles of a source to draw."""
    if isinstance(source, Simulation):
        return _of_state(source.state, source.scene)
    if isinstance(source, State):
        return _of_state(source, None)
    if isinstance(source, Scene):
        return _of_state(initial_state(source, 0), source)
    frames = source.sizes["frame"]
    if not -frames <= count_of("frame", frame, least=-frames) < frames:
        raise SceneError("frame", frame, f"must be one of {frames} frames, counted from 0")
    names = ("coordinates", "velocities", "time", "piston_position")
    # only these variables, because xarray takes milliseconds for a frame of the complete dataset
    variables = {name: source.variables[name][frame].values for name in names if name in source.variables}
    if "keep" in source.attrs:
        raise SceneError("keep", source.attrs["keep"], "a picture needs positions and velocities")
    inside = np.isfinite(variables["coordinates"]).all(axis=1)  # particles that enter and leave
    positions, velocities = (variables[name][inside].astype(float) for name in ("coordinates", "velocities"))
    scene, stored = scene_of(source), len(inside)
    return DrawnParticles(
        positions=positions,
        radii=source["radius"].values[inside],
        species=source["type"].values[inside],
        speeds=np.sqrt((velocities**2).sum(axis=1)),
        lengths=np.array(scene.container.lengths),
        walls=_walls(scene, float(variables["time"]), variables.get("piston_position")),
        masses=np.resize(per_particle(scene, "mass"), scene.capacity)[:stored][inside].astype(float),
        fixed=np.resize(per_particle(scene, "fixed"), scene.capacity)[:stored][inside].astype(bool),
        periodic=scene.image_axes,
        parameters=parameters_of(scene),
        surfaces=surfaces_of(scene, float(variables["time"]), _place(variables.get("piston_position"))),
    )


def scene_of(trajectory: xr.Dataset) -> Scene:
    """Return the scene of a trajectory, which is the same for all its frames."""
    return _scene(trajectory.attrs["scene"])


@lru_cache(maxsize=1)
def _scene(text: str) -> Scene:
    return Scene.from_dict(parse_yaml(text))


def parameters_of(scene: Scene) -> tuple[str, ...]:
    """Return the parameters of a scene that its picture does not show, as short texts."""
    kind = {2: "disc", 3: "sphere"}[scene.dimension]
    texts = [f"{scene.count} {kind}{'s' if scene.count != 1 else ''}"]
    if scene.is_open:
        texts[0] += " at the start"
    elif not scene.pistons:  # the particles do not fill the whole container
        texts.append(f"packing fraction {scene.packing_fraction:.3g}")
    if scene.gravity is not None:
        texts.append(f"gravity {math.hypot(*scene.gravity):.3g}")
    if scene.restitution is not None:
        texts.append(f"restitution {scene.restitution.normal:.3g}")
    return tuple(texts)


def _time_of(source: State | Simulation | Scene | xr.Dataset, frame: int) -> float:
    if isinstance(source, Scene):
        return 0.0
    return float(source.time if isinstance(source, State | Simulation) else source["time"].values[frame])


def _of_state(state: State, scene: Scene | None) -> DrawnParticles:
    walls = np.zeros((0, 2, state.dimension))
    if scene:
        walls = _walls(scene, state.time, None if state.piston is None else state.piston[0])
    periodic = scene.image_axes if scene else (False,) * state.dimension
    parameters = parameters_of(scene) if scene else ()
    looks = state.positions, state.radii, state.species, state.speeds
    fixed = np.isinf(state.masses)
    piston = None if state.piston is None else float(state.piston[0])
    surfaces = surfaces_of(scene, state.time, piston) if scene else ()
    return DrawnParticles(*looks, state.lengths, walls, periodic, state.masses, fixed, parameters, surfaces)


def _place(piston: np.ndarray | None) -> float | None:
    return None if piston is None else float(piston)


def _walls(scene: Scene, time: float, piston: float | np.ndarray | None) -> np.ndarray:
    """Return the segments (M, 2, d) of walls, sides of plates, and moving faces. `piston` is the position of
    a piston along its axis, if there is one.
    """
    segments: list[tuple] = []
    moving = scene.moving_wall
    for wall in scene.walls if moving is None else ():
        if isinstance(wall, Wall):
            segments.append((wall.start, wall.end))
        else:
            corner, second, third, fourth = wall.corners.values()
            segments += pairwise((corner, second, fourth, third, corner))
    lengths = np.array(scene.container.lengths)
    positions = [(moving.axis, moving.position if piston is None else float(piston))] if moving else []
    for name, face in scene.faces.items():
        axis, upper = "xyz".index(name[0]), "high" in name
        if isinstance(face, Vibrating):
            inwards = float(face.places(np.array(time)))
            positions.append((axis, lengths[axis] - inwards if upper else inwards))
        elif isinstance(face, Piston) and piston is not None:
            positions.append((axis, float(piston)))
    for axis, position in positions:
        corners = np.array(_CORNERS[scene.dimension]) * np.delete(lengths, axis)
        segments += pairwise(np.insert(corners, axis, position, axis=1))
    return np.array(segments, dtype=float).reshape(-1, 2, scene.dimension)
