"""The figures of a complete reproduction as small pictures, for the index of figures on the site:

    python docs/thumbnails.py results

`make docs` runs this. Where the workflow has drawn no figures, as in a new checkout, the site shows these
pictures, which name the config and the revisions of their results. They are kept as they are where results
are missing, or are not those of config/config.yaml.
"""

import sys
from pathlib import Path

from gallery import source
from PIL import Image

from gaspart.reproduction.families.registry import families

FOLDER = Path(__file__).with_name("figures")
WIDTH, HEIGHT = 420, 320
"""Of a picture at most, in pixels."""
_DESCRIPTION = 0x010E  # the field ImageDescription of EXIF


def path(figure: str) -> Path:
    """The picture of a figure, whether or not it exists."""
    return FOLDER / f"{figure}.webp"


def reduced(picture: Path) -> Image.Image:
    """A picture that fits into WIDTH x HEIGHT."""
    with Image.open(picture) as image:
        small = image.convert("RGB")
    small.thumbnail((WIDTH, HEIGHT))
    return small


def renew(results: Path, folder: Path = FOLDER) -> None:
    """Write the picture of every figure into a folder. Raises ValueError, and writes nothing, where one is
    missing or of another config."""
    about = Image.Exif()
    about[_DESCRIPTION] = ", ".join(source(results, families()).values())
    folder.mkdir(exist_ok=True)
    for figure in families():
        small = reduced(results / f"figures/{figure}.png")
        small.save(folder / path(figure).name, quality=70, method=6, exif=about)


if __name__ == "__main__":
    try:
        renew(Path(sys.argv[1]))
    except ValueError as error:
        print(f"{FOLDER} is kept: {error}")
