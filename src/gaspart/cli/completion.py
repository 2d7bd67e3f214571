"""`gaspart completion`: shell script that completes commands, options and names."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import Parser, set_command

SHELLS = ("bash", "zsh", "tcsh")
_EXAMPLES = """examples:
  eval "$(gaspart completion bash)"              # in this shell
  gaspart completion bash >> ~/.bash_completion  # in all later shells"""


def add_completion(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    text = "Print a script by which a shell completes commands, options and names."
    set_command(parser, _completion, text, _EXAMPLES)
    parser.add_argument("shell", choices=SHELLS, metavar="SHELL", help=", ".join(SHELLS))


def _completion(options: argparse.Namespace) -> None:
    import shtab

    print(shtab.complete(options.program, options.shell))
