"""`gaspart new`: a scene file from a template.

The templates are files of this package. The comments at the start of a template contain the title, a
description, the command that runs the scene, and the figure of the workflow with measurements of the scene.
"""

from __future__ import annotations

import argparse
import shlex
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from gaspart.cli.arguments import Parser, print_line, set_command
from gaspart.errors import SceneError
from gaspart.files import FileKind, output_path, writing
from gaspart.scene.scene import Scene

_FOLDER = Path(__file__).parent / "templates"
_CHAPTERS = {
    "Gases and fluids": ("gas", "spheres", "rarefied", "brownian", "rough"),
    "Walls": ("chambers", "osmosis", "plates", "slit", "piston", "shock", "divided", "adsorption", "sticky"),
    "Gravity": ("atmosphere", "separation"),
    "Heat and flow": (
        "heat",
        "accommodation",
        "metal",
        "lorentz",
        "shear",
        "channel",
        "gradient",
        "radiator",
        "effusion",
    ),
    "Crystals and packings": ("crystal", "melting", "packing"),
    "Grains": ("cooling", "hourglass", "galton", "shaken", "sheared", "incline"),
}
"""Names of all templates by chapter of the gallery; in a chapter, simple scenes come first."""
_EXAMPLES = """examples:
  gaspart new gas.yaml
  gaspart new hourglass.yaml      # of the template with this name
  gaspart new hot.yaml --template heat
  gaspart new --list"""


def _is_scene(path: Path) -> bool:
    try:
        Scene.from_file(path)
    except SceneError:
        return False
    return True


_SCENE = FileKind("a scene file", _is_scene)


@dataclass(frozen=True)
class Template:
    """Template of a scene. A template consists of a name, the chapter of the gallery, a title, a description,
    the command that runs the scene, the figure of the workflow (or None), and the text of the file.
    """

    name: str
    chapter: str
    title: str
    description: str
    command: str
    figure: str | None
    text: str


@cache
def templates() -> dict[str, Template]:
    """Return all templates, by name, in the order of the gallery."""
    return {name: _read(name, chapter) for chapter, names in _CHAPTERS.items() for name in names}


def _read(name: str, chapter: str) -> Template:
    path = _FOLDER / f"{name}.yaml"
    text = path.read_text(encoding="utf-8")
    comments = [line.removeprefix("# ") for line in text.splitlines() if line.startswith("#")]
    notes = [line.strip() for line in comments if line.startswith("  ")]
    description = " ".join(line for line in comments[1:] if not line.startswith("  "))
    figure = notes[1].removeprefix("figure: ") if len(notes) > 1 else None
    return Template(name, chapter, comments[0], description, notes[0], figure, text)


def add_new(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = "Write a scene file from a template. The scenes are in the gallery of the documentation."
    set_command(parser, _new, text, _EXAMPLES)
    add = parser.add_argument
    add("scene", nargs="?", metavar="FILE", help="ends in .yaml")
    add(
        "--template", choices=tuple(templates()), metavar="NAME", help="default: the name of the file, or gas"
    )
    add("--list", action="store_true", help="print the names and titles of all templates")
    add("--force", action="store_true", help="replace a scene file")


def _new(options: argparse.Namespace) -> None:
    if options.list:
        for template in templates().values():
            print_line(f"{template.name:15}{template.title}")
        return
    if options.scene is None:
        raise SceneError("scene", None, "give the name of the file, or --list")
    output = output_path(options.scene)
    usual = output.stem if output.stem in templates() else "gas"
    template = templates()[options.template or usual]
    if output.suffix not in (".yaml", ".yml") or not options.scene.isprintable():
        raise SceneError("scene", options.scene, "must be a printable name that ends in .yaml")
    command, lines = named_command(template, output), template.text.splitlines(keepends=True)
    text = "".join(line for line in lines if not line.startswith("#   figure"))  # a note for this project
    with writing(output, _SCENE, options.force) as scratch:
        scratch.write_text(text.replace(template.command, command), encoding="utf-8")
    print_line(f"{output}: {template.title}. Run it:")
    print_line(command)


def named_command(template: Template, path: Path) -> str:
    """Return the command that runs the scene of a template. The command contains the name of the scene file
    and the name of the trajectory file.
    """
    scene, trajectory = shlex.quote(str(path)), shlex.quote(str(path.with_suffix(".nc")))
    command = template.command.replace(f"{template.name}.yaml", scene)
    return command.replace(f"{template.name}.nc", trajectory)
