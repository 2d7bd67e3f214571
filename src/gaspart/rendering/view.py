"""Interactive view: an HTML page without a server or other files, drawn by WebGL."""

from __future__ import annotations

import base64
import html
import json
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gaspart.analysis.bond_order import NEIGHBOURS, hexatic, local_steinhardt
from gaspart.analysis.run import repeat_run
from gaspart.errors import SceneError
from gaspart.files import FileKind, output_path, writing
from gaspart.keys.values import count_of
from gaspart.rendering.camera import edges_of
from gaspart.rendering.frames import open_source, particles_of, scene_of
from gaspart.rendering.particles import FASTEST, FIXED, DrawnParticles
from gaspart.rendering.style import COLOURS
from gaspart.rendering.surfaces import DrawnSurface
from gaspart.scene.boundaries import refuse_open
from gaspart.scene.scene import Scene
from gaspart.simulation import Simulation
from gaspart.state.state import State
from gaspart.trajectory.opening import not_a_trajectory

if TYPE_CHECKING:
    import xarray as xr

_FOLDER = Path(__file__).parent
_RAMP = 16  # colours of the bar of speeds
_HIGHEST = 254  # levels of speeds and bond orders, stored as bytes; the next byte marks fixed particles
# number of positions on an axis: even, so that changes modulo (this number + 1) fit into two bytes
_FINEST = 65534
_PER_RADIUS = 64  # positions per smallest radius
_MARK = "gaspart view"
_MARKS = b"gaspart view", b"gaspart play"


def _is_view(path: Path) -> bool:
    with path.open("rb") as file:
        start = file.read(1000)
    return any(mark in start for mark in _MARKS)


PAGE = FileKind("a page written by gaspart view or gaspart play", _is_view)


@dataclass(frozen=True)
class View:
    """A page that shows the particles of a run, also in a notebook."""

    page: str
    height: int = 480

    def __repr__(self) -> str:
        size = len(self.page.encode()) / 1e6
        return f"<View: a page of {size:.2g} MB, which shows itself in a notebook; save(path) writes it>"

    def save(self, path: str | Path, overwrite: bool = False) -> Path:
        """Write the page to an .html file."""
        path = output_path(path)
        if path.suffix != ".html":
            raise SceneError("path", str(path), "a view must end in .html")
        with writing(path, PAGE, overwrite) as scratch:
            scratch.write_text(self.page, encoding="utf-8")
        return path

    def _repr_html_(self) -> str:
        source = html.escape(self.page)
        return f'<iframe srcdoc="{source}" style="width: 100%; height: {self.height}px; border: 0"></iframe>'


def view(source: str | Path | xr.Dataset | Simulation, frames: int = 200, order: bool = False) -> View:
    """Return an interactive view of a trajectory or a simulation; the simulation is run again.

    The page can play, turn, move and zoom. It shows colours by speed or species, faces as in pictures, a
    legend, the time and a scale.

    Positions are rounded to 1/64 of the smallest radius, or to 1/65534 of the side if that is larger. With
    ten thousand particles in 200 frames, the page has about 7 MB.

    Parameters
    ----------
    source : str, Path, Dataset or Simulation
        A trajectory (its path, or an open trajectory), or a simulation.
    frames : int, default 200
        Number of frames to show, evenly spaced.
    order : bool, default False
        Also show colours by local bond order: ``|psi_6|`` of discs, the averaged q_6 of spheres. This needs a
        periodic container and the extra `order`.

    Returns
    -------
    View
        The page, which shows itself in a notebook and can be saved.

    Raises
    ------
    SceneError
        If a simulation has not advanced, or a file cannot be read.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> simulation = gp.Simulation(scene, seed=1)
    >>> simulation.advance(duration=2.0)
    >>> gp.view(simulation, frames=5).save("gas.html").name
    'gas.html'
    """
    second: object = frames
    if isinstance(second, str | Path):
        raise SceneError("frames", str(second), "must be a number; view(source).save(path) writes the page")
    count_of("frames", frames, least=1)
    with open_source(source) as opened:
        if isinstance(opened, Scene):
            raise not_a_trajectory(opened)
        if isinstance(opened, State):
            raise SceneError(
                "source",
                f"a {type(opened).__name__}",
                "must be a trajectory or a simulation: a view needs frames",
            )
        scene = opened.scene if isinstance(opened, Simulation) else scene_of(opened)
        if order:
            refuse_open(scene, "changes the particles: bond order is of those that stay")
        data = _with_names(opened) if isinstance(opened, Simulation) else opened
        last = data.sizes["frame"] - 1
        if last < 0:
            raise SceneError("frame", 0, "the trajectory has no frame yet")
        chosen = np.unique(np.linspace(0, last, min(frames, last + 1)).round().astype(int))
        content = json.dumps(_content(data, chosen, order))
    return View(page_of("view.html", _MARK, DATA=content))


def page_of(name: str, mark: str, **parts: str) -> str:
    """Return a page from its file, the shared head and style, and texts by the words that they replace."""
    text = "".join((_FOLDER / part).read_text(encoding="utf-8") for part in ("page.html", name))
    style = (_FOLDER / "style.css").read_text(encoding="utf-8")
    for word, part in {"TITLE": mark, "STYLE": style, **parts}.items():
        text = text.replace(word, part, 1)
    return text


def _with_names(simulation: Simulation) -> xr.Dataset:
    """Return the frames of a simulation, with the variables of a trajectory that pictures need."""
    data, initial = repeat_run(simulation), simulation.initial_state
    lengths = np.tile(initial.lengths, (data.sizes["frame"], 1))
    looks = (np.resize(values, data.sizes["atom"]) for values in (initial.radii, initial.species))
    radii, species = looks  # with open faces, all particles are identical
    return data.assign(
        radius=("atom", radii), type=("atom", species), cell_lengths=(("frame", "cell"), lengths)
    )


def _content(data: xr.Dataset, chosen: np.ndarray, order: bool) -> dict:
    """Return the data of the page: numbers as base64, positions as fractions of the sides."""
    import matplotlib

    drawn = [particles_of(data, int(n)) for n in chosen]
    first, d = max(drawn, key=lambda particles: len(particles.radii)), drawn[0].dimension
    fastest = FASTEST * max(particles.root_mean_square_speed for particles in drawn) or 1.0
    steps = _resolution(first)
    positions = np.zeros((len(drawn), len(first.radii), 3), dtype=np.uint16)
    speeds = np.zeros(positions.shape[:2], dtype=np.uint8)
    for n, particles in enumerate(drawn):
        # with open faces, only the particles inside, in any order, because all are identical
        count = len(particles.radii)
        positions[n, :count, :d] = np.rint(steps * np.clip(particles.positions / particles.lengths, 0.0, 1.0))
        speeds[n, :count] = np.rint(_HIGHEST * np.clip(particles.speeds / fastest, 0.0, 1.0))
        if particles.fixed is not None:
            speeds[n, :count][particles.fixed] = _HIGHEST + 1
    lengths = np.zeros(3)
    lengths[:d] = first.lengths
    lines = _lines(lengths, [particles.walls for particles in drawn])
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 1.0, _HIGHEST + 1))[:, :3]
    return {
        "dimension": d,
        "count": len(first.radii),
        "inside": [len(particles.radii) for particles in drawn],
        "time": data["time"].values[chosen].tolist(),
        "lengths": lengths.tolist(),
        "periodic": [int(n < d and first.periodic[n]) for n in range(3)],
        "steps": steps,
        "places": _compressed_text(positions, steps + 1),
        "speeds": _compressed_text(speeds, _HIGHEST + 2),
        "fastest": fastest,
        "order": _order(drawn) if order else None,
        "radii": _text(first.radii.astype("<f4")),
        "species": _text((first.species % 256).astype(np.uint8)),
        **_looks([particles.surfaces for particles in drawn]),
        "lines": _text(lines.astype("<f4")),
        "ends": lines.shape[1],
        "map": _text(np.rint(255.0 * np.vstack([colours, [FIXED]])).astype(np.uint8)),
        "ramp": colours[:: _HIGHEST // _RAMP].round(3).tolist(),
        "palette": [list(matplotlib.colors.to_rgb(colour)) for colour in COLOURS],
    }


def _resolution(drawn: DrawnParticles) -> int:
    """Return the number of positions on an axis, above which no difference is visible."""
    smallest = float(drawn.radii.min(initial=np.inf))
    return int(min(_FINEST, _PER_RADIUS * drawn.lengths.max() / smallest + 2.0))


def _compressed_text(values: np.ndarray, modulus: int) -> str:
    """Return integers below a modulus, frame by frame, as base64 of compressed changes. Changes between
    frames are reduced by the modulus, so that a change across a periodic face is small. The changes 0, -1, 1,
    -2, 2 ... are written as 0, 1, 2, 3, 4 ... All low bytes come first, then all high bytes.
    """
    numbers = values.astype(np.int32)
    changes = (np.diff(numbers, axis=0) + modulus // 2) % modulus - modulus // 2
    numbers[1:] = np.where(changes < 0, -2 * changes - 1, 2 * changes)
    planes = numbers.astype(values.dtype.newbyteorder("<")).reshape(-1, 1).view(np.uint8).T
    return base64.b64encode(zlib.compress(planes.tobytes(), 1)).decode()


def _order(drawn: list[DrawnParticles]) -> dict:
    """Return the local bond order of every particle in every frame. The unit is the largest value on the
    scale.
    """
    first = drawn[0]
    if not all(first.periodic[: first.dimension]):
        raise SceneError("order", True, "bond order needs a periodic container")
    if len(first.radii) <= NEIGHBOURS:
        raise SceneError("order", True, f"bond order needs more than {NEIGHBOURS} particles")
    measure, name, highest = (hexatic, "|ψ6|", 1.0) if first.dimension == 2 else (local_steinhardt, "q6", 0.6)
    values = np.array([np.abs(measure(particles.positions, particles.lengths)) for particles in drawn])
    parts = np.rint(_HIGHEST * np.clip(values / highest, 0.0, 1.0)).astype(np.uint8)
    return {"values": _compressed_text(parts, _HIGHEST + 2), "name": name, "highest": highest}


def _looks(surfaces: list[tuple[DrawnSurface, ...]]) -> dict:
    """Return the appearance of faces and walls, and their corners in each frame. If nothing moves, the
    corners are returned once.
    """
    frames = [
        [
            {
                "corners": np.pad(surface.ends, ((0, 0), (0, 3 - surface.ends.shape[1]))).tolist(),
                "depth": surface.depth,
            }
            for surface in row
        ]
        for row in surfaces
    ]
    if all(row == frames[0] for row in frames):
        frames = frames[:1]
    looks = [
        {
            "text": surface.text,
            "colours": surface.colours.round(3).tolist(),
            "inward": _in_space(surface.inward),
            "dashed": surface.dashed,
            "hatched": surface.hatched,
            "motion": None if surface.motion is None else _in_space(surface.motion),
            "to_and_fro": surface.to_and_fro,
            "through": surface.through,
            "band": surface.band,
        }
        for surface in surfaces[0]
    ]
    return {"surfaces": looks, "surface_ends": frames}


def _in_space(vector: np.ndarray) -> list[float]:
    """Return a vector with three components."""
    return [*vector.tolist(), *[0.0] * (3 - len(vector))]


def _lines(lengths: np.ndarray, walls: list[np.ndarray]) -> np.ndarray:
    """Return the ends of the container's edges and of the sides of walls. The shape is (frames, 2M, 3). Walls
    have the shape (M, 2, d). If their positions are the same in all frames, there is a single frame.
    """
    if all(np.array_equal(walls[0], segments) for segments in walls):
        walls = walls[:1]
    edges = edges_of(lengths)
    ends = np.stack([edges[:, :3], edges[:, :3] + edges[:, 3:6] * edges[:, 6:]], axis=1)
    lines = np.zeros((len(walls), len(ends) + len(walls[0]), 2, 3))
    lines[:, : len(ends)] = ends
    lines[:, len(ends) :, :, : walls[0].shape[-1]] = walls
    return lines.reshape(len(walls), -1, 3)


def _text(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()
