"""Some figures of a complete reproduction in one picture, that of the README and of the site's first page:

    python docs/gallery.py results docs/gallery.png

`make docs` runs this. The picture names the config and the revisions of its results (Pillow's `Image.text`).
It is kept as it is where results are missing, or are not those of config/config.yaml.
"""

import sys
from collections.abc import Iterable
from itertools import chain
from pathlib import Path

import netCDF4
import yaml
from PIL import Image
from PIL.PngImagePlugin import PngInfo

COLUMNS = {
    ("gas_render", "brownian_render"): 640,
    ("virial_spheres", "velocity_autocorrelation"): 860,
}
"""Figures above one another -> their width in pixels."""
GAP = 12  # pixels
CONFIG = Path(__file__).parents[1] / "config/config.yaml"


def source(results: Path, figures: Iterable[str]) -> dict[str, str]:
    """The config and the revisions that figures were measured from. Raises ValueError for another config,
    and where a figure is missing."""
    title = yaml.safe_load(CONFIG.read_text(encoding="utf-8"))["title"]
    found = set()
    for name in figures:
        measurement, figure = results / f"measurements/{name}.nc", results / f"figures/{name}.png"
        if not (measurement.exists() and figure.exists()):
            raise ValueError(f"{figure} or its measurement is missing")
        with netCDF4.Dataset(measurement) as data:
            if data.config != title:
                raise ValueError(f"{measurement} is of '{data.config}', not of '{title}'")
            found.add(data.git_revision)
    return {"config": title, "revision": " ".join(sorted(found))}


def _column(folder: Path, names: tuple[str, ...], width: int) -> list[Image.Image]:
    pictures = [Image.open(folder / f"{name}.png").convert("RGB") for name in names]
    return [picture.resize((width, round(picture.height * width / picture.width))) for picture in pictures]


def gallery(results: Path, path: Path) -> None:
    """Write the figures of COLUMNS as one picture. Raises ValueError as `source`."""
    about = PngInfo()
    for key, text in source(results, chain.from_iterable(COLUMNS)).items():
        about.add_text(key, text)
    columns = [_column(results / "figures", names, width) for names, width in COLUMNS.items()]
    heights = [sum(picture.height for picture in column) + GAP * (len(column) - 1) for column in columns]
    page = Image.new("RGB", (sum(COLUMNS.values()) + GAP * (len(columns) - 1), max(heights)), "white")
    right = 0
    for column in columns:
        below = 0
        for picture in column:
            page.paste(picture, (right, below))
            below += picture.height + GAP
        right += column[0].width + GAP
    page.save(path, optimize=True, pnginfo=about)


if __name__ == "__main__":
    try:
        gallery(Path(sys.argv[1]), Path(sys.argv[2]))
    except ValueError as error:
        print(f"{sys.argv[2]} is kept: {error}")
