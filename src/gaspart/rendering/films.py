"""Films: the frames of a trajectory, one picture each."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError
from gaspart.files import Kind, begins_with, output_path, writing
from gaspart.rendering.bodies import FASTEST, bodies_of, colours_of
from gaspart.rendering.pictures import SIZE, checked_size, picture
from gaspart.trajectory import open_trajectory
from gaspart.validation import count_of, number

if TYPE_CHECKING:
    import xarray as xr

KINDS = {
    ".mp4": Kind("an MP4 film", begins_with(b"ftyp", at=4)),
    ".gif": Kind("a GIF picture", begins_with(b"GIF8")),
}


RATES = 0.01, 1000.0
"""The fewest and the most frames per second that both formats can store."""


def film(
    trajectory: str | Path | xr.Dataset,
    path: str | Path,
    size: tuple[int, int] = SIZE,
    colour: str | np.ndarray = "speed",
    frames_per_second: float = 25.0,
    trail: int | None = None,
    overwrite: bool = False,
) -> Path:
    """Write all frames of a trajectory (a path, or an open one) as a film, .mp4 or .gif; returns its path.

    size, colour as in `render`; speeds have one scale throughout. For .mp4 the size is rounded down to even
    numbers. trail: the number of a disc whose way is drawn (it ends anew where a periodic face is crossed).
    A film at `path` is replaced only with `overwrite`, any other file never.

    Raises SceneError for another suffix, a file that cannot be read or written, and what `render` refuses.
    """
    path = output_path(path)
    if path.suffix not in KINDS:
        raise SceneError("path", str(path), f"a film must end in {' or '.join(KINDS)}")
    low, high = RATES
    rule = f"must be from {low:g} to {high:g}"
    rate = number("frames_per_second", frames_per_second, rule, least=low, most=high)
    size = checked_size(size)
    if path.suffix == ".mp4":
        size = (size[0] // 2 * 2, size[1] // 2 * 2)
    to = _gif if path.suffix == ".gif" else _mp4
    with _opened(trajectory) as opened:
        shown = _pictures(opened, size, colour, trail)
        with writing(path, KINDS[path.suffix], overwrite) as scratch:
            to(scratch, shown, size, rate)
    return path


def _opened(trajectory: str | Path | xr.Dataset) -> AbstractContextManager[xr.Dataset]:
    """A trajectory, to be closed only if it was opened here."""
    if isinstance(trajectory, (str, Path)):
        return open_trajectory(trajectory)
    return nullcontext(trajectory)


def _pictures(
    trajectory: xr.Dataset, size: tuple[int, int], colour: str | np.ndarray, trail: int | None
) -> Iterator[np.ndarray]:
    """The pictures, one after the other; all is checked before the first."""
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
    return _shown(trajectory, frames, size, colour, trail)


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


def _gif(scratch: Path, shown: Iterator[np.ndarray], size: tuple[int, int], rate: float) -> None:
    from PIL import Image

    images = (Image.fromarray(image) for image in shown)
    first = next(images)
    first.save(scratch, "GIF", save_all=True, append_images=images, duration=1000.0 / rate, loop=0)


def _mp4(scratch: Path, shown: Iterator[np.ndarray], size: tuple[int, int], rate: float) -> None:
    from imageio_ffmpeg import write_frames

    options = ["-f", "mp4", "-fflags", "+bitexact", "-flags:v", "+bitexact"]  # no date, no program in it
    quiet = {"ffmpeg_log_level": "quiet"}  # the one line of an error is ours
    writer = write_frames(str(scratch), size, fps=rate, macro_block_size=2, output_params=options, **quiet)
    try:
        writer.send(None)
        for image in shown:
            writer.send(np.ascontiguousarray(image))
    finally:
        writer.close()  # returns when ffmpeg has ended, which does not report how
    if not _is_complete_mp4(scratch):
        raise OSError(errno.EIO, "its writer has failed")


def _is_complete_mp4(path: Path) -> bool:
    """Whether a file is a sequence of complete boxes, the index of the film among them."""
    size, at, kinds = path.stat().st_size, 0, set()
    with path.open("rb") as file:
        while at < size:
            file.seek(at)
            head = file.read(16)
            length = int.from_bytes(head[:4], "big")
            if length == 1:  # the size follows in 64 bits
                length = int.from_bytes(head[8:16], "big")
            if length < 8:
                return False
            kinds.add(head[4:8])
            at += length
    return at == size and b"moov" in kinds
