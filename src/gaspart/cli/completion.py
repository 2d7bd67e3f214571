"""`gaspart completion`: what a shell needs to complete commands, options and names."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import Commands, add_command

SHELLS = ("bash", "zsh", "tcsh")
_EXAMPLES = """examples:
  eval "$(gaspart completion bash)"                                  in this shell
  gaspart completion bash > ~/.local/share/bash-completion/completions/gaspart    in all to come"""


def add_completion(commands: Commands) -> None:
    """Add the command to the others."""
    text = "Print a script by which a shell completes commands, options and names."
    completion = add_command(commands, "completion", _completion, "completion in a shell", text, _EXAMPLES)
    completion.add_argument("shell", choices=SHELLS, metavar="SHELL", help=", ".join(SHELLS))


def _completion(given: argparse.Namespace) -> None:
    import shtab

    print(shtab.complete(given.program, given.shell))
