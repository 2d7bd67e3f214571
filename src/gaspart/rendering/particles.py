"""The particles in a picture and their colours."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.errors import SceneError
from gaspart.rendering.style import COLOURS
from gaspart.rendering.surfaces import DrawnSurface

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw


COLOURINGS = ("speed", "species")
FASTEST = 2.0
"""Upper end of the scale of speeds, in units of the root-mean-square speed."""
FIXED = (0.62, 0.62, 0.62)
"""Colour of fixed particles, if particles are coloured by speed."""


@dataclass(frozen=True)
class DrawnParticles:
    """Particles of a picture, with their container and walls.

    positions, radii, species, speeds : shapes (N, d), (N,), (N,), (N,).
    lengths : (d,), sides of the container.
    walls : (M, 2, d), ends of the interior walls; for plates, ends of their sides.
    periodic : True for each periodic axis.
    masses : (N,), masses if known, else None.
    fixed : (N,), True for each fixed particle; None if unknown.
    parameters : short texts on the scene.
    surfaces : faces and walls that are drawn in a special way.
    """

    positions: np.ndarray
    radii: np.ndarray
    species: np.ndarray
    speeds: np.ndarray
    lengths: np.ndarray
    walls: np.ndarray
    periodic: tuple[bool, ...] = (False, False, False)
    masses: np.ndarray | None = None
    fixed: np.ndarray | None = None
    parameters: tuple[str, ...] = ()
    surfaces: tuple[DrawnSurface, ...] = ()

    @property
    def dimension(self) -> int:
        """Number of dimensions, 2 or 3."""
        return self.positions.shape[1]

    @property
    def reach(self) -> float:
        """Maximum distance by which particles may extend beyond the container. This distance is the radius of
        the largest particle that extends beyond the container.
        """
        positions, radii = self.positions, self.radii[:, None]
        out = (np.maximum(radii - positions, positions + radii - self.lengths) > 1e-9 * self.lengths).any(
            axis=1
        )
        return float(self.radii[out].max(initial=0.0))

    @property
    def root_mean_square_speed(self) -> float:
        """Root-mean-square speed of all particles; 0 if there are no particles."""
        return float(np.sqrt((self.speeds**2).mean())) if len(self.speeds) else 0.0


@dataclass(frozen=True)
class Legend:
    """Meaning of the colours of a picture. The legend has a title, colours (M, 3), and texts. Each colour has
    a text; a continuous scale has a text at each end.
    """

    title: str
    colours: np.ndarray
    texts: tuple[str, ...]

    @property
    def continuous(self) -> bool:
        """True if the colours form a continuous scale."""
        return len(self.texts) < len(self.colours)


def legend_of(
    particles: DrawnParticles, colour: str | np.ndarray, fastest: float | None = None
) -> Legend | None:
    """Return the legend of `colours_of`; None for prescribed colours, and for one species."""
    if not isinstance(colour, str):
        return None
    if colour == "species":
        used = np.unique(particles.species)
        if len(used) < 2:
            return None
        title, texts = _differences(particles, used)
        return Legend(title, _palette()[used % len(COLOURS)], texts)
    end = _fastest(particles, fastest)
    return Legend("speed", _ramp(np.linspace(0.0, 1.0, 64)), ("0", f"{end:.3g}"))


def _differences(particles: DrawnParticles, used: np.ndarray) -> tuple[str, tuple[str, ...]]:
    """Return the properties in which these species differ, with their values in each species. If a species
    has several values, the indices of the species are returned instead.
    """
    titles, columns = [], []
    for title, values in (("radius", particles.radii), ("mass", particles.masses)):
        if values is None:
            continue
        distinct = [np.unique(values[particles.species == kind]) for kind in used]
        if any(len(unique) > 1 for unique in distinct):
            return "species", tuple(map(str, used))
        if len({float(unique[0]) for unique in distinct}) > 1:
            titles.append(title)
            columns.append([f"{unique[0]:.3g}" for unique in distinct])
    if not titles:
        return "species", tuple(map(str, used))
    return ", ".join(titles), tuple(map(", ".join, zip(*columns, strict=True)))


def _palette() -> np.ndarray:
    from matplotlib.colors import to_rgb

    return np.array([to_rgb(name) for name in COLOURS])


def _ramp(parts: np.ndarray) -> np.ndarray:
    import matplotlib

    return matplotlib.colormaps["viridis"](parts)[:, :3]


def _fastest(particles: DrawnParticles, fastest: float | None) -> float:
    """Return the upper end of the scale of speeds."""
    return (FASTEST * particles.root_mean_square_speed if fastest is None else fastest) or 1.0


def colours_of(
    particles: DrawnParticles, colour: str | np.ndarray, fastest: float | None = None
) -> np.ndarray:
    """Return the colours (N, 3) of particles: red, green and blue from 0 to 1. `colour` is "speed", "species"
    or an array (N, 3). By speed, particles are dark at rest, and bright at the speed `fastest` and above;
    fixed particles are grey. The default of `fastest` is `FASTEST` root-mean-square speeds. Raises SceneError
    for another `colour`.
    """
    if isinstance(colour, str):
        if colour not in COLOURINGS:
            raise SceneError("colour", colour, f"must be one of {', '.join(COLOURINGS)}")
        if colour == "species":
            return _palette()[particles.species % len(COLOURS)]
        colours = _ramp(particles.speeds / _fastest(particles, fastest))
        if particles.fixed is not None:
            colours[particles.fixed] = FIXED
        return colours
    values = np.asarray(colour, dtype=float)
    if values.shape != (len(particles.radii), 3):
        raise SceneError(
            "colour", f"an array of shape {values.shape}", "must have three columns, and a row per particle"
        )
    return values


# Labels of a picture: parameters, meaning of the colours, time and scale, above and below the picture.


_PART = 0.035
"""Height of the letters divided by the height of the picture; the minimum is 10 pixels.

If the height exceeds 1.5 times the width, 1.5 times the width is used instead of the height.
"""
_LINE = 1.5
"""Height of a line divided by the height of its letters."""
_INK, _PAPER = (40, 40, 40), (255, 255, 255)
_LEAST = 16
"""Minimum height of a picture between its labels, in pixels."""


def round_length(longest: float) -> float:
    """Return the largest of 1, 2 and 5 times a power of ten up to `longest`.

    >>> round_length(37.0), round_length(0.7)
    (20.0, 0.5)
    """
    power = 10.0 ** math.floor(math.log10(longest))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= longest)


def time_format(times: np.ndarray) -> str:
    """Return the format for the times of a film; all have the same number of decimals. The number of decimals
    is as large as necessary, and at most three.

    >>> time_format([0.0, 0.25, 0.5]), time_format([0.0, 1e-9])
    ('.2f', '.4g')
    """
    for decimals in range(4):
        if np.allclose(np.round(times, decimals), times, rtol=1e-9, atol=0.0):
            return f".{decimals}f"
    return ".4g"


@dataclass(frozen=True)
class Labels:
    """Text above and below a picture.

    parameters : short texts above the picture.
    legend, surfaces : legends below the parameters.

    The time and a bar of a round length are below the picture. The size of the picture is `inner`; with the
    labels it is (W, H). Raises SceneError if there is no space for the picture.
    """

    size: tuple[int, int]
    parameters: tuple[str, ...] = ()
    legend: Legend | None = None
    surfaces: tuple[DrawnSurface, ...] = ()

    def __post_init__(self) -> None:
        if self.inner[1] < _LEAST:
            raise SceneError(
                "size",
                self.size,
                "is too small for a clock and a scale: leave them out (clock=False, --plain)",
            )

    @property
    def letters(self) -> int:
        """Height of the letters, in pixels."""
        width, height = self.size
        return max(10, round(_PART * min(height, 1.5 * width)))

    @property
    def line(self) -> int:
        """Height of a line, in pixels."""
        return round(_LINE * self.letters)

    @cached_property
    def font(self) -> Any:
        """Font of all labels."""
        from PIL import ImageFont

        return ImageFont.load_default(self.letters)

    @cached_property
    def lines(self) -> list[str]:
        """Parameters in lines that are no wider than the picture. They are left out if they take more than
        half of the picture.
        """
        lines: list[str] = []
        for text in self.parameters:
            longer = f"{lines[-1]}, {text}" if lines else text
            if lines and self.font.getlength(longer) <= self.size[0] - self.letters:
                lines[-1] = longer
            else:
                lines.append(text)
        return lines if 2 * self.line * (len(lines) + 2) <= self.size[1] else []

    @property
    def top(self) -> int:
        """Height of the strip above the picture."""
        rows = len(self.lines) + (self.legend is not None) + len(self.rows)
        return self.line * rows + self.letters // 3

    @cached_property
    def rows(self) -> list[list[DrawnSurface]]:
        """Surfaces in rows that are no wider than the picture. They are left out if they take more than half
        of the picture.
        """
        rows: list[list[DrawnSurface]] = []
        free = 0.0
        for surface in self.surfaces:
            width = self._sample + self.letters + self.font.getlength(surface.text)
            if not rows or width > free:
                rows.append([])
                free = self.size[0] - self.letters // 2
            rows[-1].append(surface)
            free -= width
        used = len(self.lines) + (self.legend is not None) + len(rows) + 1
        return rows if 2 * self.line * used <= self.size[1] else []

    @property
    def _sample(self) -> int:
        """Length of the sample line for a surface in the legend, in pixels."""
        return 2 * self.letters

    @property
    def inner(self) -> tuple[int, int]:
        """Size (W, H) of the picture without labels."""
        return self.size[0], self.size[1] - self.top - self.line - self.letters // 3

    def add_to(self, image: np.ndarray, time: str, pixels_per_length: float) -> np.ndarray:
        """Add the labels to a picture (h, W, 3) of size `inner`; return (H, W, 3)."""
        from PIL import Image, ImageDraw

        width, height = self.size
        paper = Image.new("RGB", self.size, _PAPER)
        paper.paste(Image.fromarray(image), (0, self.top))
        draw = ImageDraw.Draw(paper)
        gap = self.letters // 2
        for n, text in enumerate(self.lines):
            self._write(draw, (gap, (n + 0.75) * self.line), text)
        if self.legend is not None:
            self._draw_legend(draw, self.legend, (len(self.lines) + 0.75) * self.line)
        first = len(self.lines) + (self.legend is not None) + 0.75
        for n, row in enumerate(self.rows):
            self._draw_surfaces(draw, row, (first + n) * self.line)
        base = height - gap - 1
        self._write(draw, (gap, base), f"t = {time}")
        length = round_length(0.25 * width / pixels_per_length)
        right = width - gap
        start = right - length * pixels_per_length
        y = base - round(0.35 * self.letters)
        draw.line([(start, y), (right, y)], _INK, max(2, self.letters // 8))
        for end in (start, right):
            draw.line([(end, y - gap // 2), (end, y + gap // 2)], _INK, 1)
        self._write(draw, (start - gap, base), f"length {length:g}", "rs")
        return np.asarray(paper)

    def _draw_surfaces(self, draw: ImageDraw, row: list[DrawnSurface], base: float) -> None:
        """Draw the lines of some surfaces and their meanings side by side in the legend."""
        x, y, thick = self.letters / 2, base - 0.3 * self.letters, max(3, self.letters // 5)
        for surface in row:
            count = 5 if surface.dashed else len(surface.colours)
            for n in range(0, count, 2 if surface.dashed else 1):
                colour = surface.colours[n * len(surface.colours) // count]
                start, end = (x + self._sample * part / count for part in (n, n + 1))
                fill = tuple(np.rint(255.0 * colour).astype(int).tolist())
                draw.line([(start, y), (end, y)], fill, thick)
            for tick in range(5) if surface.hatched else ():
                at = x + self._sample * (tick + 0.5) / 5
                draw.line([(at, y), (at - thick, y + 1.5 * thick)], _INK, 1)
            x = (
                self._write(draw, (x + self._sample + self.letters // 3, base), surface.text)
                + self.letters // 2
            )

    def _write(self, draw: ImageDraw, position: tuple[float, float], text: str, anchor: str = "ls") -> float:
        """Write a text, and return the coordinate of its right end."""
        draw.text(position, text, _INK, self.font, anchor)
        return draw.textbbox(position, text, self.font, anchor)[2]

    def _draw_legend(self, draw: ImageDraw, legend: Legend, base: float) -> None:
        """Draw the legend: title, and a bar with numbers at its ends, or colours with texts."""
        letters, gap = self.letters, self.letters // 2
        colours = [tuple(colour) for colour in np.rint(255.0 * legend.colours).astype(int).tolist()]
        x = self._write(draw, (gap, base), legend.title) + gap

        def block(end: float, colour: tuple[int, ...]) -> float:
            draw.rectangle([x, base - 0.7 * letters, end, base], colour)
            return end

        if legend.continuous:
            x = self._write(draw, (x, base), legend.texts[0]) + gap // 2
            start, length = x, 0.2 * self.size[0]
            for n, colour in enumerate(colours, start=1):
                x = block(start + n * length / len(colours), colour)
            self._write(draw, (x + gap // 2, base), legend.texts[1])
            return
        for colour, text in zip(colours, legend.texts, strict=True):
            x = self._write(draw, (block(x + letters, colour) + gap // 2, base), text) + gap
