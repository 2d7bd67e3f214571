"""What the program can show, in pictures: python docs/contact_sheet.py

Writes docs/gallery.md, a page with the picture of every template of `gaspart new`, and
docs/scenes.png, the picture of the README: some of them in one. Both follow from docs/scenes
(`scene_pictures.py`).
"""

from itertools import groupby
from pathlib import Path

from PIL import Image

from gaspart.cli.new import Template, templates

DOCS = Path(__file__).parent
SHOWN = ("spheres", "packing", "plates", "slit", "cooling", "shaken", "hourglass", "melting")
"""Templates in the picture of the README, in rows of COLUMNS."""
COLUMNS, WIDTH, GAP = 4, 320, 12  # pixels
_INTRODUCTION = """# Gallery

Scenes to start from, from the simple to the special. `gaspart new NAME.yaml --template NAME` writes the
file of one and prints the command that runs it; `gaspart film NAME.nc -o NAME.mp4` makes its film,
`gaspart films FOLDER` those of all, for slides. A name leads to its file.
"""


def sheet() -> Image.Image:
    """The picture of the README."""
    pictures = [Image.open(DOCS / f"scenes/{name}.png").convert("RGB") for name in SHOWN]
    height = WIDTH * pictures[0].height // pictures[0].width
    rows = -(-len(pictures) // COLUMNS)
    size = (COLUMNS * (WIDTH + GAP) - GAP, rows * (height + GAP) - GAP)
    page = Image.new("RGB", size, "white")
    for n, picture in enumerate(pictures):
        place = ((n % COLUMNS) * (WIDTH + GAP), (n // COLUMNS) * (height + GAP))
        page.paste(picture.resize((WIDTH, height), Image.Resampling.LANCZOS), place)
    return page


def page() -> str:
    """The text of the gallery: a table of pictures for each chapter."""
    text = _INTRODUCTION
    for chapter, made in groupby(templates().values(), key=lambda template: template.chapter):
        text += f"\n## {chapter}\n\n|   |   |   |\n| --- | --- | --- |\n"
        cells = [_cell(template) for template in made]
        cells += [" "] * (-len(cells) % 3)
        for n in range(0, len(cells), 3):
            text += f"| {' | '.join(cells[n : n + 3])} |\n"
    return text


def _cell(template: Template) -> str:
    picture = f"![{template.title}](scenes/{template.name}.png)"
    file = f"[`{template.name}`](../src/gaspart/cli/templates/{template.name}.yaml)"
    return f"{picture}<br>{file}: **{template.title}.** {template.description}"


if __name__ == "__main__":
    (DOCS / "gallery.md").write_text(page(), encoding="utf-8")
    sheet().quantize(256).save(DOCS / "scenes.png", optimize=True)
