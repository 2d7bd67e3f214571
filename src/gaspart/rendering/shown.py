"""What notebooks show of pictures and films: they are arrays and paths, which know how to show themselves."""

from __future__ import annotations

import base64
import html
import io
from pathlib import Path

import numpy as np

LARGEST_FILM = 50_000_000
"""Bytes of a film that a notebook is to hold; a larger one is a link."""


class Picture(np.ndarray):
    """An array of pixels, uint8 (H, W, 3), that a notebook shows as a picture. Parts and results of
    arithmetic that are no picture are shown as arrays."""

    def _repr_png_(self) -> bytes | None:
        """The picture as the content of a PNG file; None for an array that is none."""
        if self.dtype != np.uint8 or self.ndim != 3 or self.shape[2] != 3 or not self.size:
            return None
        from PIL import Image

        content = io.BytesIO()
        Image.fromarray(np.ascontiguousarray(self)).save(content, "PNG")
        return content.getvalue()

    def figure(self, caption: str) -> str:
        """The picture with a line of text below it, as a piece of HTML."""
        source = f"data:image/png;base64,{base64.b64encode(self._repr_png_() or b'').decode()}"
        text = html.escape(caption)
        image = f'<img src="{source}" alt="{text}" style="max-width: 100%">'
        return f'<figure style="margin: 0">{image}<figcaption>{text}</figcaption></figure>'


class Film(type(Path())):  # type: ignore[misc]
    """The path of a film, .mp4 or .gif, which a notebook shows."""

    def _repr_html_(self) -> str | None:
        """The film, inside the notebook if it is not too large; None where there is no file."""
        if not self.is_file():
            return None
        name = html.escape(str(self))
        if self.stat().st_size > LARGEST_FILM:
            return f'<a href="{name}">{name}</a>'
        content = base64.b64encode(self.read_bytes()).decode()
        if self.suffix == ".gif":
            return f'<img src="data:image/gif;base64,{content}" alt="{name}">'
        return f'<video src="data:video/mp4;base64,{content}" controls loop style="max-width: 100%"></video>'
