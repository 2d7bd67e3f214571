"""The time and the scale of a picture, written into its lower corners."""

from __future__ import annotations

import math

import numpy as np

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


def labelled(image: np.ndarray, time: float, pixels_per_length: float | None = None) -> np.ndarray:
    """A copy of a picture (H, W, 3) with the time at the left and, if `pixels_per_length` is given, a bar of
    a round length at the right."""
    from PIL import Image, ImageDraw, ImageFont

    height, width = image.shape[:2]
    letters = max(10, round(_PART * height))
    picture = Image.fromarray(image)
    draw = ImageDraw.Draw(picture)
    font = ImageFont.load_default(letters)
    gap = letters // 2
    text = f"t = {time:.4g}"
    draw.rectangle(draw.textbbox((gap, height - gap), text, font, "ls"), _PAPER)
    draw.text((gap, height - gap), text, _INK, font, "ls")
    if pixels_per_length is not None:
        length = round_length(0.25 * width / pixels_per_length)
        right, y = width - gap, height - gap
        left = right - length * pixels_per_length
        number = f"{length:g}"
        above = right, y - gap // 2 - 1
        draw.rectangle(draw.textbbox(above, number, font, "rs"), _PAPER)
        draw.text(above, number, _INK, font, "rs")
        draw.line([(left, y), (right, y)], _INK, max(2, letters // 8))
    return np.asarray(picture)
