"""The command line: a module for each command, with its arguments and its function.

A user's mistake is one line on stderr and exit code 2. A run that breaks an invariant, a failure of a file or
of memory, or an error found by `check`: 1. An interruption: 130 (SIGINT) or 143 (SIGTERM).
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import TextIO

from gaspart import __version__
from gaspart.cli.advise import add_advise
from gaspart.cli.arguments import Parser, UsageError
from gaspart.cli.check import CheckFailed, add_check
from gaspart.cli.collisions import add_collisions
from gaspart.cli.completion import add_completion
from gaspart.cli.export import add_export
from gaspart.cli.info import add_info
from gaspart.cli.measure import add_measure
from gaspart.cli.new import add_new
from gaspart.cli.progress import clear_line
from gaspart.cli.render import add_render
from gaspart.cli.run import add_resume, add_run
from gaspart.cli.theory import add_theory
from gaspart.cli.view import add_view
from gaspart.errors import SceneError, SimulationError, unknown_word
from gaspart.interruption import interrupted, set_note

_COMMANDS = {
    "new": add_new,
    "run": add_run,
    "resume": add_resume,
    "info": add_info,
    "measure": add_measure,
    "render": add_render,
    "view": add_view,
    "collisions": add_collisions,
    "export": add_export,
    "theory": add_theory,
    "advise": add_advise,
    "check": add_check,
    "completion": add_completion,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Carry out a command line; returns the exit code."""
    try:
        set_note("")
        try:
            given, left = _parser().parse_known_args(arguments)
            if left:
                raise UsageError(_unrecognised(left, given.parser))
            given.command(given)
        finally:
            sys.stdout.flush()  # here, where a full disk can still be reported
    except (SceneError, UsageError) as error:
        return _complain(f"error: {error}", 2)
    except CheckFailed:
        return 1
    except SimulationError as error:
        return _complain(f"error: {error}", 1)
    except KeyboardInterrupt:
        return _complain(interrupted(), 130)
    except MemoryError:
        return _complain("error: there is not enough memory for this", 1)
    except BrokenPipeError:  # the reader of the output has ended, as `head` does
        _discard(sys.stdout)
    except OSError as error:
        where = error.filename or "a file or the standard output"
        return _complain(f"error: {where}: {error.strerror or error}", 1)
    return 0


def _complain(text: str, code: int) -> int:
    """Print one line on stderr; returns the exit code."""
    for stream, line in (
        (sys.stdout, ""),
        (sys.stderr, f"{clear_line()}gaspart: {' '.join(text.split())}\n"),
    ):
        try:
            stream.write(line)
            stream.flush()
        except OSError:  # full or closed: only the exit code is left
            _discard(stream)
    return code


def _discard(stream: TextIO) -> None:
    """Redirect a stream to the null device, where the interpreter can flush it."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, stream.fileno())
    os.close(null)


def _unrecognised(words: list[str], parser: Parser) -> str:
    """The message for words of a command line that its command does not take."""
    options = [word.partition("=")[0] for word in words if word.startswith("-")]
    if options:
        return f"{options[0]}: {unknown_word(options[0], parser.options(), 'option')}"
    return f"{' '.join(words)}: too many arguments; see `{parser.prog} --help`"


def _parser() -> Parser:
    parser = Parser(prog="gaspart", description="Hard-sphere and hard-disc gases.")
    parser.add_argument("--version", action="version", version=f"gaspart {__version__}")
    _add_commands(parser)
    parser.set_defaults(program=parser)
    return parser


def _add_commands(parser: Parser) -> dict[str, Parser]:
    added = parser.add_subparsers(required=True, metavar=" | ".join(_COMMANDS))
    for add in _COMMANDS.values():
        add(added)
    return dict(added.choices)


def commands() -> dict[str, Parser]:
    """The parser of each command, by name."""
    return _add_commands(Parser(prog="gaspart", description=""))
