"""The pictures of the gallery of scenes: python docs/scene_pictures.py FOLDER [NAME ...]

Each template is run by its own command, and the last frame drawn; of some a film is made as well, which the
gallery shows instead. Scenes whose faces or walls have looks of their own get labels, with the legend of
these. Without names: all templates.
"""

import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageSequence

import gaspart as gp
from gaspart.cli.new import templates
from gaspart.cli.view import colour_of, run_template
from gaspart.rendering.surfaces import surfaces_of
from gaspart.yaml_text import parse_yaml

WIDTH, HEIGHT = 640, 480  # pixels
PALETTE = 128  # colours of a PNG file
FILMED = ("piston", "shock", "divided", "hourglass", "shaken", "incline")
"""Templates whose motion a picture does not show."""
FILM_SIZE, FRAMES, RATE = (320, 240), 40, 12.5  # pixels, at least, per second


def draw(name, folder):
    """Run a template in a folder of its own, and write folder/name.png, and of FILMED folder/name.webp."""
    template = templates()[name]
    with tempfile.TemporaryDirectory() as scratch:
        run = run_template(template, Path(scratch))
        labels = bool(surfaces_of(gp.Scene.from_dict(parse_yaml(template.text))))
        pixels = gp.render(run, size=(WIDTH, HEIGHT), colour=colour_of(template), clock=labels)
        if name in FILMED:
            film(run, colour_of(template), folder / f"{name}.webp")
    Image.fromarray(pixels).quantize(PALETTE).save(folder / f"{name}.png", optimize=True)


def film(run, colour, path):
    """Write a film of a run as an animated picture, half the size of the .gif of `gp.film`."""
    with gp.open_trajectory(run) as frames:
        every = max(1, frames.sizes["frame"] // FRAMES)
    made = gp.film(
        run,
        run.with_suffix(".gif"),
        size=FILM_SIZE,
        colour=colour,
        every=every,
        frames_per_second=RATE,
        clock=False,
    )
    with Image.open(made) as gif:
        first, *others = (frame.convert("RGB") for frame in ImageSequence.Iterator(gif))
    first.save(path, save_all=True, append_images=others, duration=1000 / RATE, loop=0, quality=50, method=4)


if __name__ == "__main__":
    to = Path(sys.argv[1])
    to.mkdir(exist_ok=True)
    for name in sys.argv[2:] or templates():
        draw(name, to)
