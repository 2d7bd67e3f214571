"""The time, the scale and the meaning of the colours, written into the corners of a picture."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gaspart.rendering.particles import Legend

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw

_PART = 0.035
"""Height of the letters over that of the picture; at least 10 pixels."""
_INK, _PAPER = (40, 40, 40), (255, 255, 255)


def round_length(longest: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above `longest`.

    >>> round_length(37.0), round_length(0.7)
    (20.0, 0.5)
    """
    power = 10.0 ** math.floor(math.log10(longest))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= longest)


def labelled(image: np.ndarray, time: float, pixels_per_length: float, legend: Legend | None) -> np.ndarray:
    """A copy of a picture (H, W, 3) with the time at the lower left, a bar of a round length at the lower
    right, and the legend, if there is one, at the upper left."""
    from PIL import Image, ImageDraw, ImageFont

    height, width = image.shape[:2]
    letters = max(10, round(_PART * height))
    picture = Image.fromarray(image)
    draw = ImageDraw.Draw(picture)
    font = ImageFont.load_default(letters)
    gap = letters // 2
    _write(draw, (gap, height - gap), f"t = {time:.4g}", font, "ls")
    length = round_length(0.25 * width / pixels_per_length)
    right, y = width - gap, height - gap
    _write(draw, (right, y - gap // 2 - 1), f"{length:g}", font, "rs")
    draw.line([(right - length * pixels_per_length, y), (right, y)], _INK, max(2, letters // 8))
    if legend is not None:
        _draw_legend(draw, legend, font, letters, width)
    return np.asarray(picture)


def _write(draw: ImageDraw, place: tuple[float, float], text: str, font: Any, anchor: str) -> float:
    """Write a text on paper; returns where it ends, to the right."""
    box = draw.textbbox(place, text, font, anchor)
    draw.rectangle(box, _PAPER)
    draw.text(place, text, _INK, font, anchor)
    return box[2]


def _draw_legend(draw: ImageDraw, legend: Legend, font: Any, letters: int, width: int) -> None:
    """The title, and a bar between the numbers of its ends, or each colour with its text."""
    gap, base = letters // 2, letters // 2 + letters
    colours = [tuple(colour) for colour in np.rint(255.0 * legend.colours).astype(int).tolist()]
    x = _write(draw, (gap, base), legend.title, font, "ls") + gap

    def block(end: float, colour: tuple[int, ...]) -> float:
        draw.rectangle([x, base - 0.7 * letters, end, base], colour)
        return end

    if legend.continuous:
        x = _write(draw, (x, base), legend.texts[0], font, "ls") + gap // 2
        start, length = x, 0.2 * width
        for n, colour in enumerate(colours, start=1):
            x = block(start + n * length / len(colours), colour)
        _write(draw, (x + gap // 2, base), legend.texts[1], font, "ls")
        return
    for colour, text in zip(colours, legend.texts, strict=True):  # with paper around each, as on particles
        draw.rectangle([x - 2, base - 0.7 * letters - 2, x + letters + 2, base + 2], _PAPER)
        x = _write(draw, (block(x + letters, colour) + gap // 2, base), text, font, "ls") + gap
