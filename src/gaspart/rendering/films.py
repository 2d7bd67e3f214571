"""Films: the frames of a trajectory, one picture each."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.files import writing
from gaspart.rendering.bodies import FASTEST, bodies_of, colours_of
from gaspart.rendering.pictures import SIZE, checked_size, picture
from gaspart.scene.validation import count_of, number
from gaspart.trajectory.run import open_trajectory

if TYPE_CHECKING:
    import xarray as xr

FORMATS = (".mp4", ".gif")


def film(
    trajectory: str | Path | xr.Dataset,
    path: str | Path,
    size: tuple[int, int] = SIZE,
    colour: str | np.ndarray = "speed",
    frames_per_second: float = 25.0,
    trail: int | None = None,
) -> Path:
    """Write all frames of a trajectory (a path, or an open one) as a film, .mp4 or .gif; returns its path.

    size, colour as in `render`; speeds have one scale throughout. For .mp4 the size is rounded down to even
    numbers. trail: the number of a disc whose way is drawn (it ends anew where a periodic face is crossed).

    Raises SceneError for another suffix, a file that cannot be read or written, and what `render` refuses.
    """
    path = Path(path)
    if path.suffix not in FORMATS:
        raise SceneError("path", str(path), f"a film must end in {' or '.join(FORMATS)}")
    rate = number("frames_per_second", frames_per_second, "must be positive", above=0.0)
    size = checked_size(size)
    if path.suffix == ".mp4":
        size = (size[0] // 2 * 2, size[1] // 2 * 2)
    if isinstance(trajectory, (str, Path)):
        with open_trajectory(trajectory) as opened:
            return _write(opened, path, size, colour, rate, trail)
    return _write(trajectory, path, size, colour, rate, trail)


def _write(
    trajectory: xr.Dataset,
    path: Path,
    size: tuple[int, int],
    colour: str | np.ndarray,
    rate: float,
    trail: int | None,
) -> Path:
    """See `film`; all is checked before the first frame is drawn."""
    frames = trajectory.sizes["frame"]
    if frames == 0:
        raise SceneError("frame", 0, "the trajectory has no frame yet")
    first = bodies_of(trajectory, 0)
    colours_of(first, colour)
    if trail is not None:
        if count_of("trail", trail) >= len(first.radii):
            raise SceneError("trail", trail, f"the trajectory has {len(first.radii)} bodies")
        if first.dimension != 2:
            raise SceneError("trail", trail, "is drawn among discs only")
    with writing(path) as partial:
        shown = _shown(trajectory, frames, size, colour, trail)
        if path.suffix == ".gif":
            _gif(partial, shown, rate)
        else:
            _mp4(partial, shown, size, rate)
    return path


def _shown(
    trajectory: xr.Dataset,
    frames: int,
    size: tuple[int, int],
    colour: str | np.ndarray,
    trail: int | None,
) -> Iterator[np.ndarray]:
    """The pictures, one after the other."""
    fastest = FASTEST * max(bodies_of(trajectory, n).root_mean_square_speed for n in range(frames))
    way = []
    for n in range(frames):
        bodies = bodies_of(trajectory, n)
        if trail is not None:
            way.append(bodies.positions[trail])
        lines = _pieces(way, bodies.lengths)
        yield picture(bodies, size, colours_of(bodies, colour, fastest), lines)


def _pieces(way: list[np.ndarray], lengths: np.ndarray) -> list[np.ndarray]:
    """A way as lines (M, 2), cut where it leaves the container to come in on the other side."""
    if len(way) < 2:
        return []
    points = np.array(way)
    jumps = (np.abs(np.diff(points, axis=0)) > 0.5 * lengths).any(axis=1)
    return [part for part in np.split(points, np.flatnonzero(jumps) + 1) if len(part) > 1]


def _gif(partial: Path, shown: Iterator[np.ndarray], rate: float) -> None:
    from PIL import Image

    images = (Image.fromarray(image) for image in shown)
    first = next(images)
    first.save(partial, "GIF", save_all=True, append_images=images, duration=1000.0 / rate, loop=0)


def _mp4(partial: Path, shown: Iterator[np.ndarray], size: tuple[int, int], rate: float) -> None:
    from imageio_ffmpeg import write_frames

    options = ["-f", "mp4", "-fflags", "+bitexact", "-flags:v", "+bitexact"]  # no date, no program in it
    writer = write_frames(str(partial), size, fps=rate, macro_block_size=2, output_params=options)
    writer.send(None)
    for image in shown:
        writer.send(np.ascontiguousarray(image))
    writer.close()
