"""`gaspart films`: films of the scenes of the gallery, such as for slides."""

from __future__ import annotations

import argparse
import contextlib
import os
import shlex
import sys
import tempfile
from pathlib import Path

from gaspart.cli.arguments import Parser, pixels, print_line, set_command
from gaspart.cli.new import Template, named_command, templates
from gaspart.cli.progress import clear_line, counted, waiting
from gaspart.errors import SceneError, unknown_word

_SIZE = 1280, 720  # of slides, 16:9
_BY_SPECIES = ("separation", "brownian", "hourglass", "shaken", "slit", "packing")
"""Templates whose species are seen better than speeds."""
_EXAMPLES = """examples:
  gaspart films slides              # of all scenes of `gaspart new --list`
  gaspart films slides shaken hourglass --gif --size 640x360"""


def add_films(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "Run scenes of `gaspart new`, each by its own command, and film them: NAME.mp4 in a folder, which is "
        "made if there is none. A film that is there is kept, so that the same command continues."
    )
    set_command(parser, _films, text, _EXAMPLES)
    add = parser.add_argument
    add("folder", metavar="FOLDER", help="folder of the films")
    add("names", nargs="*", metavar="NAME", help="names of scenes; default: all")
    add("--gif", action="store_true", help="NAME.gif instead of NAME.mp4")
    add("--size", type=pixels, default=_SIZE, metavar="WxH", help="in pixels; default: 1280x720")


def colour_of(template: Template) -> str:
    """By what the particles of a template are coloured."""
    return "species" if template.name in _BY_SPECIES else "speed"


def run_template(template: Template, folder: Path) -> Path:
    """The trajectory of a template in a folder, made by its own command. Raises as `gaspart run` does."""
    from gaspart.cli import commands

    scene = folder / f"{template.name}.yaml"
    scene.write_text(template.text, encoding="utf-8")
    _, name, *arguments = shlex.split(named_command(template, scene))
    given = commands()[name].parse_args([*arguments, "--quiet"])
    with open(os.devnull, "w") as null, contextlib.redirect_stdout(null):
        given.command(given)
    return scene.with_suffix(".nc")


def _films(given: argparse.Namespace) -> None:
    from gaspart.rendering.films import FILM_FORMATS, film

    known = templates()
    for name in given.names:
        if name not in known:
            raise SceneError("name", name, unknown_word(name, known, "name"))
    folder = Path(given.folder)
    if folder.suffix in (".nc", *FILM_FORMATS):
        of_one = f"gaspart film {folder.stem}.nc -o {folder.stem}.mp4"
        rule = f"must be a folder, for films of the gallery; of one trajectory: {of_one}"
        raise SceneError("folder", given.folder, rule)
    folder.mkdir(parents=True, exist_ok=True)
    for name in given.names or known:
        output = folder / f"{name}.{'gif' if given.gif else 'mp4'}"
        if not output.exists():
            with tempfile.TemporaryDirectory() as scratch:
                with waiting(f"running {name}"):
                    trajectory = run_template(known[name], Path(scratch))
                colour = colour_of(known[name])
                film(trajectory, output, size=given.size, colour=colour, progress=counted())
                print(clear_line(), end="", file=sys.stderr)
        print_line(output)
