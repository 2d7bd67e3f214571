"""The command line: a module for each command, which adds it to the parser and carries it out.

A user's mistake is one line on stderr and exit code 2; a run that broke an invariant, or something that
`check` finds wrong, 1; Ctrl-C, 130.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from gaspart import __version__
from gaspart.cli.advise import add_advise
from gaspart.cli.arguments import Parser, UsageError
from gaspart.cli.check import Wrong, add_check
from gaspart.cli.collisions import add_collisions
from gaspart.cli.export import add_export
from gaspart.cli.info import add_info
from gaspart.cli.progress import clear_line
from gaspart.cli.render import add_render
from gaspart.cli.run import add_resume, add_run
from gaspart.cli.theory import add_theory
from gaspart.errors import SceneError, SimulationError

_COMMANDS = {
    "run": add_run,
    "resume": add_resume,
    "info": add_info,
    "render": add_render,
    "collisions": add_collisions,
    "export": add_export,
    "theory": add_theory,
    "advise": add_advise,
    "check": add_check,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Carry out a command line; returns the exit code."""
    try:
        given = _parser().parse_args(arguments)
        given.command(given)
    except (SceneError, UsageError) as error:
        return _complain(error, 2)
    except Wrong:
        return 1
    except MemoryError:
        return _complain("there is not enough memory for this", 2)
    except SimulationError as error:
        return _complain(error, 1)
    except KeyboardInterrupt:
        return _complain("interrupted; an unfinished run is kept, and `gaspart resume` goes on with it", 130)
    except BrokenPipeError:  # the reader of the output, `head` say, has had enough
        sys.stderr.close()
        return 0
    return 0


def _complain(error: object, code: int) -> int:
    text = " ".join(str(error).split())
    print(f"{clear_line()}gaspart: error: {text}", file=sys.stderr)
    return code


def _parser() -> Parser:
    parser = Parser(prog="gaspart", description="Hard-sphere and hard-disc gases.")
    parser.add_argument("--version", action="version", version=f"gaspart {__version__}")
    commands = parser.add_subparsers(required=True, metavar=" | ".join(_COMMANDS))
    for add in _COMMANDS.values():
        add(commands)
    return parser
