"""`gaspart view`: an interactive page of a trajectory."""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import shlex
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
from gaspart.cli.new import Template, named_command, templates
from gaspart.cli.progress import clear_line, picture_progress, waiting
from gaspart.errors import SceneError, unknown_word
from gaspart.files import output_path, writing
from gaspart.interruption import scratch_folder

_EXAMPLES = """examples:
  gaspart view run.nc -o run.html
  gaspart view run.nc -o run.html --frames 50
  gaspart view crystal.nc -o crystal.html --order"""


def add_view(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "Write one page of HTML that shows a trajectory in any browser, without a server: play, turn, move "
        "and zoom, colours by speed, species or bond order, time and scale."
    )
    set_command(parser, _view, text, _EXAMPLES)
    add_trajectory(parser)
    add_output(parser, "ends in .html", "a page written by this command")
    text = "number of frames shown, evenly spaced; default: 200"
    parser.add_argument("--frames", type=integer(least=1), default=200, metavar="N", help=text)
    text = "also colours by local bond order (periodic containers; needs the extra `order`)"
    parser.add_argument("--order", action="store_true", help=text)


def _view(options: argparse.Namespace) -> None:
    from gaspart.rendering.view import view

    with waiting("writing the page"):
        path = view(options.trajectory, options.frames, options.order).save(options.output, options.force)
    print_line(path)


# `gaspart render`: a picture or a film of a trajectory.


PICTURES = (".png",)
_OF_FILMS = ("frames_per_second", "start", "stop", "every", "trail", "plain")


_EXAMPLES_OF_PICTURES = """examples:
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
    set_command(parser, _render, text, _EXAMPLES_OF_PICTURES)
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


def _render(options: argparse.Namespace) -> None:
    output = output_path(options.output)
    named = ("size", "colour", "frame", *_OF_FILMS, "clock", "camera")
    keywords = {key: getattr(options, key) for key in named if getattr(options, key) is not None}
    if output.suffix in PICTURES and not options.film:
        for key in _OF_FILMS:
            if key in keywords:
                raise SceneError(key, keywords[key], "has no meaning for a picture")
        _picture(options.trajectory, output, keywords, options.force)
    else:
        from gaspart.rendering.films import FILM_FORMATS, film

        endings = FILM_FORMATS if options.film else (*PICTURES, *FILM_FORMATS)
        if output.suffix not in endings:
            raise SceneError("output", options.output, f"must end in {', '.join(endings)}")
        if "frame" in keywords:
            raise SceneError("frame", options.frame, "has no meaning for a film, which shows all frames")
        keywords["clock"] = not keywords.pop("plain", False)
        film(options.trajectory, output, **keywords, overwrite=options.force, progress=picture_progress())
        print(clear_line(), end="", file=sys.stderr)
    print_line(output)


def _picture(trajectory: str, output: Path, options: dict, overwrite: bool) -> None:
    from PIL import Image

    from gaspart.rendering.frames import render
    from gaspart.rendering.pictures import PICTURE

    with writing(output, PICTURE, overwrite) as scratch:
        picture = io.BytesIO()  # first, because Pillow does not report why it cannot write
        Image.fromarray(render(trajectory, **options)).save(picture, "PNG")
        scratch.write_bytes(picture.getvalue())


# `gaspart films`: films of the scenes in the gallery, for example for slides.


_SIZE = 1280, 720  # format 16:9 of slides
_BY_SPECIES = ("separation", "brownian", "hourglass", "shaken", "slit", "packing")
"""Templates in which colours by species are more instructive than colours by speed."""
_EXAMPLES_OF_GALLERY = """examples:
  gaspart films slides              # of all scenes of `gaspart new --list`
  gaspart films slides shaken hourglass --gif --size 640x360"""


def add_films(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "Run scenes of `gaspart new`, each by its own command, and film them: NAME.mp4 in a folder, which is "
        "made if there is none. A film that is there is kept, so that the same command continues."
    )
    set_command(parser, _films, text, _EXAMPLES_OF_GALLERY)
    add = parser.add_argument
    add("folder", metavar="FOLDER", help="folder of the films")
    add("names", nargs="*", metavar="NAME", help="names of scenes; default: all")
    add("--gif", action="store_true", help="NAME.gif instead of NAME.mp4")
    add("--size", type=pixels, default=_SIZE, metavar="WxH", help="in pixels; default: 1280x720")


def colour_of(template: Template) -> str:
    """Return the property by which particles of a template are coloured."""
    return "species" if template.name in _BY_SPECIES else "speed"


def run_template(template: Template, folder: Path) -> Path:
    """Write the trajectory of a template to a folder by the command in the template. Raises the same errors
    as the command `gaspart run`.
    """
    from gaspart.cli import commands

    scene = folder / f"{template.name}.yaml"
    scene.write_text(template.text, encoding="utf-8")
    _, name, *arguments = shlex.split(named_command(template, scene))
    options = commands()[name].parse_args([*arguments, "--quiet"])
    with open(os.devnull, "w") as null, contextlib.redirect_stdout(null):
        options.command(options)
    return scene.with_suffix(".nc")


def _films(options: argparse.Namespace) -> None:
    from gaspart.rendering.films import FILM_FORMATS, film

    gallery = templates()
    for name in options.names:
        if name not in gallery:
            raise SceneError("name", name, unknown_word(name, gallery, "name"))
    folder = Path(options.folder)
    if folder.suffix in (".nc", *FILM_FORMATS):
        of_one = f"gaspart film {folder.stem}.nc -o {folder.stem}.mp4"
        rule = f"must be a folder, for films of the gallery; of one trajectory: {of_one}"
        raise SceneError("folder", options.folder, rule)
    folder.mkdir(parents=True, exist_ok=True)
    for name in options.names or gallery:
        output = folder / f"{name}.{'gif' if options.gif else 'mp4'}"
        if not output.exists():
            with scratch_folder() as scratch:
                with waiting(f"running {name}"):
                    trajectory = run_template(gallery[name], scratch)
                colour = colour_of(gallery[name])
                film(trajectory, output, size=options.size, colour=colour, progress=picture_progress())
                print(clear_line(), end="", file=sys.stderr)
        print_line(output)
