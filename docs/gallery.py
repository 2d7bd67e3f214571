"""Some figures of a reproduction in one picture: python docs/gallery.py results/figures docs/gallery.png"""

import sys
from pathlib import Path

from PIL import Image

COLUMNS = (
    ("gas_render", "brownian_render"),
    ("virial_spheres",),
    ("velocity_autocorrelation",),
    ("separation",),
)
WIDTH, GAP = 420, 12  # pixels


def _column(folder: Path, names: tuple[str, ...]) -> list[Image.Image]:
    pictures = [Image.open(folder / f"{name}.png").convert("RGB") for name in names]
    return [picture.resize((WIDTH, round(picture.height * WIDTH / picture.width))) for picture in pictures]


def gallery(folder: Path, path: Path) -> None:
    """Write the figures of COLUMNS, from a folder of them, as one picture."""
    columns = [_column(folder, names) for names in COLUMNS]
    heights = [sum(picture.height for picture in column) + GAP * (len(column) - 1) for column in columns]
    page = Image.new("RGB", (len(columns) * (WIDTH + GAP) - GAP, max(heights)), "white")
    for k, column in enumerate(columns):
        below = 0
        for picture in column:
            page.paste(picture, (k * (WIDTH + GAP), below))
            below += picture.height + GAP
    page.save(path, optimize=True)


if __name__ == "__main__":
    gallery(Path(sys.argv[1]), Path(sys.argv[2]))
