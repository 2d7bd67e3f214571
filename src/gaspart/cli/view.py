"""`gaspart view`: an interactive page of a trajectory."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import Parser, add_output, add_trajectory, integer, print_line, set_command
from gaspart.cli.progress import waiting

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


def _view(given: argparse.Namespace) -> None:
    from gaspart.rendering.view import view

    with waiting("writing the page"):
        path = view(given.trajectory, given.frames, given.order).save(given.output, given.force)
    print_line(path)
