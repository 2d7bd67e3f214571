"""The pictures of the gallery of scenes: python docs/scene_pictures.py FOLDER [NAME ...]

Each template is run by its own command, and the last frame drawn. Without names: all templates.
"""

import os
import shlex
import sys
import tempfile
from pathlib import Path

from PIL import Image

import gaspart as gp
from gaspart.cli import main
from gaspart.cli.new import templates

WIDTH, HEIGHT = 640, 480  # pixels
COLOUR = dict.fromkeys(("separation", "brownian", "hourglass", "shaken", "slit", "packing"), "species")
PALETTE = 128  # colours of a PNG file


def draw(name, folder):
    """Run a template in the present folder, and write folder/name.png."""
    template = templates()[name]
    Path(f"{name}.yaml").write_text(template.text, encoding="utf-8")
    program, *arguments = shlex.split(template.command)
    assert program == "gaspart" and main([*arguments, "--quiet"]) == 0
    with gp.open_trajectory(f"{name}.nc") as run:
        pixels = gp.render(run, size=(WIDTH, HEIGHT), colour=COLOUR.get(name, "speed"))
    Image.fromarray(pixels).quantize(PALETTE).save(folder / f"{name}.png", optimize=True)


if __name__ == "__main__":
    to = Path(sys.argv[1]).absolute()
    to.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        for name in sys.argv[2:] or templates():
            draw(name, to)
