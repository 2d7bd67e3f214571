"""`gaspart play`: a page on which a gas runs in any browser."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import Parser, UsageError, add_output, integer, print_line, set_command
from gaspart.cli.new import templates
from gaspart.cli.progress import waiting

_EXAMPLES = """examples:
  gaspart play -o gas.html
  gaspart play --template heat -o heat.html
  gaspart play scene.yaml -o scene.html --seed 2"""


def add_play(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = (
        "Write one page of HTML on which a gas of discs runs in any browser, without a server: pause, heat, "
        "compress, reverse it, and read gauges with errors and theory. It has the bits of `gaspart run`. The "
        "first page of a kind of scene compiles its kernels, in about a minute."
    )
    set_command(parser, _play, text, _EXAMPLES)
    parser.add_argument("scene", nargs="?", metavar="SCENE", help="scene file (YAML)")
    text = "scene of `gaspart new` instead of a file; default: gas"
    parser.add_argument("--template", choices=tuple(templates()), metavar="NAME", help=text)
    add_output(parser, "ends in .html", "a page written by this command")
    text = "seed of the initial state and of thermal walls; default: 0"
    parser.add_argument("--seed", type=integer(), default=0, metavar="N", help=text)


def _play(options: argparse.Namespace) -> None:
    from gaspart.rendering.play import play
    from gaspart.scene.scene import Scene
    from gaspart.yaml_text import parse_yaml

    if options.scene and options.template:
        raise UsageError("give a scene or --template, not both")
    if options.scene:
        scene = Scene.from_file(options.scene)
    else:
        scene = Scene.from_dict(parse_yaml(templates()[options.template or "gas"].text))
    with waiting("making the page; new kernels take a minute"):
        path = play(scene, options.seed).save(options.output, options.force)
    print_line(path)
