"""Films: the frames of a trajectory as pictures."""

from __future__ import annotations

import errno
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from gaspart.errors import SceneError, optional
from gaspart.files import FileKind, begins_with, output_path, whole_file, writing
from gaspart.keys.values import count_of, number
from gaspart.rendering.frames import Film, open_source, particles_of, scene_of
from gaspart.rendering.particles import FASTEST, Labels, colours_of, legend_of, time_format
from gaspart.rendering.pictures import SIZE, checked_camera, checked_size, picture, pixels_per_length
from gaspart.scene.boundaries import refuse_open
from gaspart.scene.scene import Scene
from gaspart.simulation import Simulation
from gaspart.state.state import State
from gaspart.system import path_for_others
from gaspart.trajectory.opening import not_a_trajectory

if TYPE_CHECKING:
    import xarray as xr

FILM_FORMATS = {
    ".mp4": FileKind("an MP4 film", begins_with(b"ftyp", at=4)),
    ".gif": FileKind("a GIF picture", begins_with(b"GIF8")),
}


RATES = 0.01, 1000.0
"""Smallest and largest number of frames per second that both formats can store."""


def film(
    trajectory: str | Path | xr.Dataset,
    path: str | Path,
    *,
    size: tuple[int, int] = SIZE,
    colour: str | np.ndarray = "speed",
    frames_per_second: float = 25.0,
    start: float | None = None,
    stop: float | None = None,
    every: int = 1,
    trail: int | None = None,
    clock: bool = True,
    camera: tuple[float, float] | None = None,
    overwrite: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Film:
    """Write the frames of a trajectory as a film, .mp4 or .gif.

    Parameters
    ----------
    trajectory : str, Path or Dataset
        The trajectory: its path, or an open trajectory.
    path : str or Path
        The film to write, with the suffix .mp4 (which needs the extra `film`) or .gif.
    size : tuple of int, default (1000, 750)
        Width and height in pixels; for .mp4 they are rounded down to even numbers.
    colour : {"speed", "species"} or ndarray, shape (N, 3), default "speed"
        Colours of the particles as in `render`. All frames have the same scale of speeds.
    frames_per_second : float, default 25.0
        Frames per second.
    start : float, [time], optional
        Time of the first frame to show. Default: all frames.
    stop : float, [time], optional
        Time of the last frame to show. Default: all frames.
    every : int, default 1
        Show every `every`-th frame.
    trail : int, optional
        Index of a disc whose path is drawn. The path is interrupted where it crosses a periodic face.
    clock : bool, default True
        Write parameters and times as in `render`.
    camera : tuple of float, optional
        Azimuth and elevation in degrees as in `render`.
    overwrite : bool, default False
        Replace a film at `path`. Files of other kinds are never replaced.
    progress : callable, optional
        Function that is called as ``progress(done, pictures)`` after each picture.

    Returns
    -------
    Film
        Path of the film. In a notebook it shows the film.

    Raises
    ------
    SceneError
        If the suffix is unknown, a file cannot be read or written, or `render` rejects an argument.

    Examples
    --------
    >>> import gaspart as gp
    >>> scene = gp.Scene(gp.Container((9.0, 9.0)), [gp.Species(20, 0.2, temperature=1.0)])
    >>> path = gp.run(scene, seed=1, duration=2.0, sample_interval=1.0, path="gas.nc")
    >>> gp.film(path, "gas.gif", size=(80, 60), clock=False).name
    'gas.gif'
    """
    path = output_path(path)
    if path.suffix not in FILM_FORMATS:
        raise SceneError("path", str(path), f"a film must end in {' or '.join(FILM_FORMATS)}")
    low, high = RATES
    rule = f"must be from {low:g} to {high:g}"
    rate = number("frames_per_second", frames_per_second, rule, least=low, most=high)
    size = checked_size(size)
    if path.suffix == ".mp4":
        size = (size[0] // 2 * 2, size[1] // 2 * 2)
        _ffmpeg()  # checked before any picture is drawn
    to = _gif if path.suffix == ".gif" else _mp4
    with open_source(trajectory) as source:
        if isinstance(source, Scene):
            raise not_a_trajectory(source)
        if isinstance(source, Simulation | State):
            raise SceneError(
                "trajectory",
                source,
                "must be a path or an open trajectory: a film needs frames; gaspart.run(scene, path=...) "
                "writes them",
            )
        source = _part(source, start, stop, every)
        direction = _check_arguments(source, colour, trail, camera)
        images = _pictures(source, size, colour, trail, clock, direction)
        if progress is not None:
            images = _report_progress(images, source.sizes["frame"], progress)
        with writing(path, FILM_FORMATS[path.suffix], overwrite) as scratch:
            to(scratch, images, size, rate)
    return Film(path)


def poster(source: str | Path, path: str | Path) -> None:
    """Write the middle picture of an MP4 film as a JPEG file. A page shows this picture until the
    film plays.
    """
    from imageio_ffmpeg import count_frames_and_secs, read_frames
    from PIL import Image

    number, _ = count_frames_and_secs(str(source))
    frames = read_frames(str(source))
    size = next(frames)["size"]
    try:
        image = next(islice(frames, number // 2, None))
    finally:
        frames.close()
    with whole_file(path) as partial:
        Image.frombytes("RGB", size, image).save(partial, "JPEG", quality=85)


def _report_progress(
    images: Iterator[np.ndarray], total: int, progress: Callable[[int, int], None]
) -> Iterator[np.ndarray]:
    for done, image in enumerate(images, start=1):
        yield image
        progress(done, total)


def _part(source: xr.Dataset, start: float | None, stop: float | None, every: int) -> xr.Dataset:
    """Return every `every`-th frame between two times. Raises SceneError if there is no frame."""
    time = source["time"].values
    first = -np.inf if start is None else number("start", start, "must be a finite number")
    last = np.inf if stop is None else number("stop", stop, "must be a finite number")
    slack = 1e-9 * abs(float(time[-1]))
    frames = np.flatnonzero((time >= first - slack) & (time <= last + slack))
    if not frames.size:
        raise SceneError("start", start, f"must have a frame between it and {last:g}")
    return source.isel(frame=frames[:: count_of("every", every, least=1)])


def _check_arguments(
    trajectory: xr.Dataset,
    colour: str | np.ndarray,
    trail: int | None,
    camera: tuple[float, float] | None,
) -> tuple[float, float]:
    """Return the direction of the camera. Raises SceneError if no picture could be drawn."""
    if trajectory.sizes["frame"] == 0:
        raise SceneError("frame", 0, "the trajectory has no frame yet")
    first = particles_of(trajectory, 0)
    colours_of(first, colour)
    direction = checked_camera(camera, first.dimension)
    if trail is not None:
        refuse_open(scene_of(trajectory), "changes the particles: a trail is of one that stays")
        if count_of("trail", trail) >= len(first.radii):
            raise SceneError("trail", trail, f"must be below {len(first.radii)}, the number of particles")
        if first.dimension != 2:
            raise SceneError("trail", trail, "requires discs")
    return direction


def _pictures(
    trajectory: xr.Dataset,
    size: tuple[int, int],
    colour: str | np.ndarray,
    trail: int | None,
    clock: bool,
    direction: tuple[float, float],
) -> Iterator[np.ndarray]:
    """Yield the pictures in order."""
    fastest = None
    if isinstance(colour, str) and colour == "speed":  # all frames have the same scale
        frames = range(trajectory.sizes["frame"])
        fastest = FASTEST * max(particles_of(trajectory, n).root_mean_square_speed for n in frames)
    first, times, path = particles_of(trajectory, 0), trajectory["time"].values, []
    labels = None
    if clock:
        labels = Labels(size, first.parameters, legend_of(first, colour, fastest), first.surfaces)
    inner = labels.inner if labels else size
    scale, decimals = pixels_per_length(first, inner, direction), time_format(times)
    for n, time in enumerate(times):
        particles = particles_of(trajectory, n)
        if trail is not None:
            path.append(particles.positions[trail])
        paths = pieces(path, particles.lengths)
        image = picture(particles, inner, colours_of(particles, colour, fastest), paths, direction)
        yield labels.add_to(image, f"{time:{decimals}}", scale) if labels else image


def pieces(path: list[np.ndarray], lengths: np.ndarray) -> list[np.ndarray]:
    """Cut a path into lines (M, 2) where it crosses a periodic face."""
    if len(path) < 2:
        return []
    points = np.array(path)
    jumps = (np.abs(np.diff(points, axis=0)) > 0.5 * lengths).any(axis=1)
    return [part for part in np.split(points, np.flatnonzero(jumps) + 1) if len(part) > 1]


def _gif(scratch: Path, pictures: Iterator[np.ndarray], size: tuple[int, int], rate: float) -> None:
    """Write each picture when it is drawn: the part that differs from the picture before, with its palette.
    Pillow's own films are written at the end, with all pictures in memory.
    """
    from PIL import Image, ImageChops
    from PIL.GifImagePlugin import getdata, getheader

    timing, before = {"duration": 1000.0 / rate}, None
    with scratch.open("wb") as file:
        for pixels in pictures:
            image = Image.fromarray(pixels)
            indexed = image.convert("P", palette=Image.Palette.ADAPTIVE)
            if before is None:
                file.writelines(getheader(indexed, info={"loop": 0, **timing})[0])
                file.writelines(getdata(indexed, (0, 0), **timing))
            else:
                box = ImageChops.difference(before, image).getbbox() or (0, 0, 1, 1)
                file.writelines(getdata(indexed.crop(box), box[:2], include_color_table=True, **timing))
            before = image
        file.write(b";")


def _ffmpeg() -> ModuleType:
    return optional("imageio_ffmpeg", "film", "films as .mp4 (.gif needs nothing more)")


def _mp4(scratch: Path, images: Iterator[np.ndarray], size: tuple[int, int], rate: float) -> None:
    # the file contains no date and no program name
    options = ["-f", "mp4", "-fflags", "+bitexact", "-flags:v", "+bitexact"]
    quiet = {"ffmpeg_log_level": "quiet"}  # gaspart prints errors in one line itself
    write_frames = _ffmpeg().write_frames
    with scratch.open("rb") as file:
        # written to the file that this process has open: if a signal has removed the file, ffmpeg would
        # create it again by its name
        path = path_for_others(file)
        writer = write_frames(path, size, fps=rate, macro_block_size=2, output_params=options, **quiet)
        try:
            writer.send(None)
            for image in images:
                writer.send(np.ascontiguousarray(image))
        finally:
            writer.close()  # returns when ffmpeg has ended, without its exit code
    if not _is_complete_mp4(scratch):
        raise OSError(errno.EIO, "its writer has failed")


def _is_complete_mp4(path: Path) -> bool:
    """Return True if a file is a sequence of complete boxes that includes the film's index."""
    size, at, kinds = path.stat().st_size, 0, set()
    with path.open("rb") as file:
        while at < size:
            file.seek(at)
            head = file.read(16)
            length = int.from_bytes(head[:4], "big")
            if length == 1:  # the size follows as a 64-bit number
                length = int.from_bytes(head[8:16], "big")
            if length < 8:
                return False
            kinds.add(head[4:8])
            at += length
    return at == size and b"moov" in kinds
