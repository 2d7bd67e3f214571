"""Command line: a module for each command, with its arguments and its function.

A user's mistake is reported by one line on stderr and exit code 2. The exit code is 1 if a run violates an
invariant, if reading or writing a file fails, if memory is insufficient, or if `check` finds an error. After
an interruption it is 130 (SIGINT) or 143 (SIGTERM).
"""

from __future__ import annotations

import argparse
import errno
import os
import sys
import warnings
from collections.abc import Iterable, Sequence
from importlib import import_module
from typing import TextIO

from gaspart import __version__
from gaspart.cli.arguments import CheckFailed, Parser, UsageError
from gaspart.cli.progress import clear_line
from gaspart.errors import SceneError, SimulationError, unknown_word, visible
from gaspart.files import OVERWRITE
from gaspart.interruption import describe_interruption, set_note

_COMMANDS = {
    "new": ("new", "write a scene file from a template"),
    "run": ("run", "run a scene and write its trajectory"),
    "resume": ("run", "finish a run that was cut short"),
    "info": ("check", "contents and quality of a trajectory, and how to reproduce it"),
    "measure": ("measure", "observables of a trajectory, with uncertainties and theory"),
    "render": ("view", "a picture (.png) or a film (.mp4, .gif) of a trajectory"),
    "film": ("view", "a film (.mp4, .gif) of a trajectory"),
    "films": ("view", "films of the scenes of the gallery, such as for slides"),
    "view": ("view", "an interactive page (.html) of a trajectory"),
    "play": ("play", "a page (.html) on which a gas runs in any browser"),
    "collisions": ("export", "run a scene and write a data set of its collisions"),
    "export": ("export", "a frame as a state for other programs (.gsd, .data)"),
    "theory": ("theory", "values of theory, with sources"),
    "advise": ("advise", "the cheapest engine and settings for an accuracy"),
    "check": ("check", "validate a scene, a config or a trajectory, also of other programs"),
    "budget": ("archive", "where the time of a finished run of the workflow went, and which length suffices"),
    "archive": ("archive", "a finished run of the workflow as one file to deposit"),
    "verify": ("archive", "digests of an archive, and points simulated again"),
    "completion": ("arguments", "let a shell complete commands, options and names"),
}
"""Commands by name: the module, which has a function add_<name>, and the line in the list of commands."""
_WRITE_FILES = ("new", "resume", "run")  # commands with an option `output` do this
_EXAMPLES = """examples:
  gaspart new gas.yaml
  gaspart run gas.yaml -o gas.nc --duration 40 --sample-interval 0.4
  gaspart render gas.nc -o gas.mp4
  gaspart run --help"""


def lines() -> dict[str, str]:
    """Return the description of each command in `gaspart --help`, by its name."""
    return {name: line for name, (_, line) in _COMMANDS.items()}


def main(arguments: Sequence[str] | None = None, without_output: bool = False) -> int:
    """Execute a command line, and return the exit code. If `without_output` is True, the standard output is
    closed. A command that prints its result there then fails.
    """
    options: argparse.Namespace | None = None
    try:
        set_note("")
        try:
            words = sys.argv[1:] if arguments is None else arguments
            try:
                options, unknown = _parser(words).parse_known_args(words)
            except SystemExit:  # after --help or --version
                if without_output:
                    raise OSError(errno.EBADF, os.strerror(errno.EBADF)) from None
                raise
            if unknown:
                raise UsageError(_describe_unrecognised(unknown, options.parser))
            writes_file = words[0] in _WRITE_FILES and not getattr(options, "list", False)
            if without_output and getattr(options, "output", None) is None and not writes_file:
                raise OSError(errno.EBADF, os.strerror(errno.EBADF))
            _silence_matplotlib()
            options.command(options)
        finally:
            sys.stdout.flush()  # flushed here, because a full disk can still be reported here
    except (SceneError, UsageError) as error:
        return _complain(f"error: {_for_command(error, options)}", 2)
    except CheckFailed:
        return 1
    except SimulationError as error:
        return _complain(f"error: {error}", 1)
    except KeyboardInterrupt:
        return _complain(describe_interruption(), 130)
    except MemoryError:
        return _complain("error: there is not enough memory for this", 1)
    except BrokenPipeError:  # the program that reads the output has ended, such as `head`
        _discard(sys.stdout)
    except OSError as error:
        where = error.filename or "a file or the standard output"
        return _complain(f"error: {where}: {error.strerror or error}", 1)
    return 0


def _for_command(error: Exception, options: argparse.Namespace | None) -> str:
    """Return the text of an error for the given command. The text names the file of the scene. It names the
    option of the command instead of Python's `overwrite`.
    """
    if (
        isinstance(error, SceneError)
        and error.file is None
        and isinstance(getattr(options, "scene", None), str)
    ):
        assert options is not None
        if error.key.partition(".")[0].partition("[")[0] in _scene_keys():
            error = error.inside("", options.scene)
    has_option = options is None or "--force" in options.parser.options()
    return str(error).replace(OVERWRITE, f"overwrite it ({'' if has_option else 'gaspart run '}--force)")


def _scene_keys() -> set[str]:
    """Return the keys of a scene file, and names of quantities derived from them."""
    from dataclasses import fields

    from gaspart.scene.container import Container
    from gaspart.scene.scene import Scene
    from gaspart.scene.species import Species

    return {"packing_fraction"} | {field.name for cls in (Scene, Container, Species) for field in fields(cls)}


def _complain(text: str, code: int) -> int:
    """Print a text as one line on stderr, and return the exit code `code`."""
    for stream, line in (
        (sys.stdout, ""),
        (sys.stderr, f"{clear_line()}gaspart: {visible(' '.join(text.split()))}\n"),
    ):
        try:
            stream.write(line)
            stream.flush()
        except OSError:  # stderr is full or closed: only the exit code remains
            _discard(stream)
    return code


def _silence_matplotlib() -> None:
    """Print no remarks of matplotlib, such as one about a home folder that cannot be written."""
    import logging  # here, because the list of commands does not need it

    logging.getLogger("matplotlib").setLevel(logging.ERROR)


def show_warnings_in_a_line() -> None:
    """Print warnings of gaspart in one line, without Python's source line, until the process ends."""
    print_with_place = warnings.showwarning

    def show(message: Warning | str, *location: object, **more: object) -> None:
        text = str(message)
        if text.startswith("gaspart: "):
            _complain(f"warning: {text.removeprefix('gaspart: ')}", 0)
        else:
            print_with_place(message, *location, **more)  # type: ignore[arg-type]

    warnings.showwarning = show


def _discard(stream: TextIO) -> None:
    """Redirect a stream to the null device, so that the interpreter can flush it."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, stream.fileno())
    os.close(null)


def _describe_unrecognised(words: list[str], parser: Parser) -> str:
    """Return the message about words that a command does not accept."""
    options = [argument.partition("=")[0] for argument in words if argument.startswith("-")]
    if options:
        rule = unknown_word(options[0], parser.options(), "option").partition("; known are")
        return f"{options[0]}: {rule[0]}" + (f"; see `{parser.prog} --help`" if rule[1] else "")
    return f"{' '.join(words)}: too many arguments; see `{parser.prog} --help`"


def _parser(words: Sequence[str]) -> Parser:
    """Return the parser of a command line. The parser contains only the command at the beginning of the line,
    or a list of all commands. Only the module of this command is imported; `completion` imports all modules.
    """
    parser = Parser(
        prog="gaspart",
        description="Simulate hard-sphere and hard-disc gases, measure and draw them.",
        epilog=_EXAMPLES,
    )
    parser.add_argument("--version", action="version", version=f"gaspart {__version__}")
    named = next((argument for argument in words if argument in _COMMANDS), "")
    alone = named != "completion" and list(words[:1]) == [named]
    complete = _COMMANDS if named == "completion" else (named,)
    _add_commands(parser, (named,) if alone else _COMMANDS, complete)
    parser.set_defaults(program=parser)
    return parser


def _add_commands(parser: Parser, names: Iterable[str], complete: Iterable[str]) -> dict[str, Parser]:
    """Add commands; commands outside of `complete` have only a name and a brief description."""
    added = parser.add_subparsers(required=True, metavar="COMMAND", title="commands", parser_class=Parser)
    for name in names:
        module, brief = _COMMANDS[name]
        its = added.add_parser(name, help=brief)
        if name in complete:
            getattr(import_module(f"gaspart.cli.{module}"), f"add_{name}")(its)
    return dict(added.choices)


def commands() -> dict[str, Parser]:
    """Return the parser of each command, by name."""
    return _add_commands(Parser(prog="gaspart"), _COMMANDS, _COMMANDS)
