"""`gaspart render`: a picture or a film of a trajectory."""

from __future__ import annotations

import argparse
import io
import sys
from pathlib import Path

from gaspart.cli.arguments import (
    Parser,
    add_output,
    add_trajectory,
    integer,
    pixels,
    print_line,
    real,
    set_command,
    several,
)
from gaspart.cli.progress import clear_line, counted
from gaspart.errors import SceneError
from gaspart.files import output_path, writing

PICTURES = (".png",)
_OF_FILMS = ("frames_per_second", "start", "stop", "every", "trail", "plain")


_EXAMPLES = """examples:
  gaspart render run.nc -o run.png
  gaspart render run.nc -o run.mp4 --frames-per-second 30 --colour species
  gaspart render run.nc -o part.mp4 --start 10 --stop 20 --every 2
  gaspart render run.nc -o top.png --camera 0,90 --clock"""
_EXAMPLES_OF_FILMS = """examples:
  gaspart film run.nc -o run.mp4
  gaspart film run.nc -o run.gif --frames-per-second 30 --colour species
  gaspart film run.nc -o part.mp4 --start 10 --stop 20 --every 2 --plain"""


def add_render(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "A picture (.png) of one frame of a trajectory, or a film (.mp4, .gif) of all: spheres with light "
        "and shadow, discs from above."
    )
    set_command(parser, _render, text, _EXAMPLES)
    add_trajectory(parser)
    add_output(parser, "ends in .png, .mp4 or .gif", "a picture or a film")
    parser.add_argument(
        "--frame",
        type=integer(),
        metavar="N",
        help="picture: counted from 0, or from the end if negative; default: -1",
    )
    _add_options(parser)
    text = (
        "picture: write the parameters, the meaning of the colours, the time and the scale above and below it"
    )
    parser.add_argument("--clock", action="store_true", default=None, help=text)
    parser.set_defaults(film=False)


def add_film(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = "A film (.mp4, .gif) of a trajectory: `gaspart render` of all frames, with the same options."
    set_command(parser, _render, text, _EXAMPLES_OF_FILMS)
    add_trajectory(parser)
    add_output(parser, "ends in .mp4 or .gif", "a film")
    _add_options(parser)
    parser.set_defaults(frame=None, clock=None, film=True)


def _add_options(parser: Parser) -> None:
    """Add the options that `gaspart render` and `gaspart film` share."""
    add = parser.add_argument
    add("--size", type=pixels, metavar="WxH", help="in pixels; default: 1000x750")
    add("--colour", metavar="NAME", help="speed (default) or species")
    add("--frames-per-second", type=real(above=0.0), metavar="X", help="film; default: 25")
    add("--start", type=real(), metavar="T", help="film: from this time on; default: the first frame")
    add("--stop", type=real(), metavar="T", help="film: until this time; default: the last frame")
    add("--every", type=integer(least=1), metavar="N", help="film: one of so many frames; default: 1")
    add(
        "--trail",
        type=integer(least=0),
        metavar="N",
        help="film of discs: draw the path of particle N, counted from 0",
    )
    text = "film: without the parameters, the meaning of the colours, the time and the scale around it"
    add("--plain", action="store_true", default=None, help=text)
    text = "direction from which spheres are seen: azimuth and elevation in degrees; default: 298,24"
    add("--camera", type=several(real()), metavar="A,E", help=text)


def _render(given: argparse.Namespace) -> None:
    output = output_path(given.output)
    named = ("size", "colour", "frame", *_OF_FILMS, "clock", "camera")
    options = {key: getattr(given, key) for key in named if getattr(given, key) is not None}
    if output.suffix in PICTURES and not given.film:
        for key in _OF_FILMS:
            if key in options:
                raise SceneError(key, options[key], "has no meaning for a picture")
        _picture(given.trajectory, output, options, given.force)
    else:
        from gaspart.rendering.films import FILM_FORMATS, film

        endings = FILM_FORMATS if given.film else (*PICTURES, *FILM_FORMATS)
        if output.suffix not in endings:
            raise SceneError("output", given.output, f"must end in {', '.join(endings)}")
        if "frame" in options:
            raise SceneError("frame", given.frame, "has no meaning for a film, which shows all frames")
        options["clock"] = not options.pop("plain", False)
        film(given.trajectory, output, **options, overwrite=given.force, progress=counted())
        print(clear_line(), end="", file=sys.stderr)
    print_line(output)


def _picture(trajectory: str, output: Path, options: dict, overwrite: bool) -> None:
    from PIL import Image

    from gaspart.rendering.frames import render
    from gaspart.rendering.pictures import PICTURE

    with writing(output, PICTURE, overwrite) as scratch:
        picture = io.BytesIO()  # first, because Pillow does not report what keeps it from writing
        Image.fromarray(render(trajectory, **options)).save(picture, "PNG")
        scratch.write_bytes(picture.getvalue())
