"""The pictures of the gallery of scenes: python docs/scene_pictures.py FOLDER [NAME ...]

Each template is run by its own command, and the last frame drawn. Scenes whose faces or walls have looks of
their own get labels, with the legend of these. Without names: all templates.
"""

import sys
import tempfile
from pathlib import Path

from PIL import Image

import gaspart as gp
from gaspart.cli.new import templates
from gaspart.cli.view import colour_of, run_template
from gaspart.rendering.surfaces import surfaces_of
from gaspart.yaml_text import parse_yaml

WIDTH, HEIGHT = 640, 480  # pixels
PALETTE = 128  # colours of a PNG file


def draw(name, folder):
    """Run a template in a folder of its own, and write folder/name.png."""
    template = templates()[name]
    with tempfile.TemporaryDirectory() as scratch:
        run = run_template(template, Path(scratch))
        labels = bool(surfaces_of(gp.Scene.from_dict(parse_yaml(template.text))))
        pixels = gp.render(run, size=(WIDTH, HEIGHT), colour=colour_of(template), clock=labels)
    Image.fromarray(pixels).quantize(PALETTE).save(folder / f"{name}.png", optimize=True)


if __name__ == "__main__":
    to = Path(sys.argv[1])
    to.mkdir(exist_ok=True)
    for name in sys.argv[2:] or templates():
        draw(name, to)
