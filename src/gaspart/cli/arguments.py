"""Common parts of the commands: parser, conversion of numbers, shared options."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from textwrap import fill
from typing import Any, NoReturn, TypeVar

from gaspart.errors import entry_points_of, unknown_word, visible
from gaspart.keys.values import number

T = TypeVar("T")
WIDTH = 78
"""Width of the help text in characters, for a terminal of 80 columns."""


class UsageError(Exception):
    """Invalid command line, with the message of argparse."""


class CheckFailed(Exception):
    """Error for a failed check about which a line has already been printed."""


class Suggested(tuple):
    """Words that a shell suggests as completions; other words are accepted, too."""

    def __contains__(self, name: object) -> bool:
        return True


class Parser(argparse.ArgumentParser):
    """Parser that raises UsageError, accepts only unabbreviated options, and preserves line breaks."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(allow_abbrev=False, formatter_class=argparse.RawDescriptionHelpFormatter, **settings)

    def error(self, message: str) -> NoReturn:
        """Raise UsageError with a message of argparse."""
        raise UsageError(message + (f"; see `{self.prog} --help`" if "are required" in message else ""))

    def _print_message(self, message: str, file: Any = None) -> None:
        """Print a text; argparse itself ignores errors, such as that of a full disk."""
        print(message, end="", file=file)

    def options(self) -> list[str]:
        """Return all options, such as --seed."""
        return [option for action in self._actions for option in action.option_strings]

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Raise an error that suggests the most similar choice for an unknown word."""
        if action.choices is not None and value not in action.choices:
            kind = "command" if action.nargs == argparse.PARSER else "name"
            option = f"{action.option_strings[0]}: " if action.option_strings else ""
            raise UsageError(f"{option}{value!r}: {unknown_word(value, map(str, action.choices), kind)}")


def real(**limits: float) -> Callable[[str], float]:
    """Return a function that converts text to a finite number within limits. The limits `above`, `least` and
    `most` are explained in `gaspart.keys.values.number`.
    """
    return _reader(float, "a finite number", limits)


def integer(**limits: float) -> Callable[[str], int]:
    """Return a function that converts text to an integer within the limits of `real`."""
    return _reader(int, "a whole number", limits)


def _reader(kind: Callable[[str], T], name: str, limits: dict[str, float]) -> Callable[[str], T]:
    words = {"above": "above", "least": "at least", "most": "at most"}
    rule = " and ".join([f"must be {name}", *(f"{words[key]} {limits[key]:g}" for key in limits)])

    def read(text: str) -> T:
        try:
            value = kind(text)
            number("", value, rule, **limits)
        except (ValueError, OverflowError):
            raise argparse.ArgumentTypeError(f"{text!r} {rule}") from None
        return value

    return read


def pixels(text: str) -> tuple[int, int]:
    """Read a width and a height, such as 1000x750."""
    try:
        width, height = (int(part) for part in text.split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} must be of the form 1000x750") from None
    return width, height


def set_command(
    parser: Parser,
    run: Callable[[argparse.Namespace], None],
    description: str,
    examples: str | None = None,
) -> None:
    """Describe a command in its parser, with the function `run` that executes it."""
    parser.description, parser.epilog = fill(description, width=WIDTH), examples
    parser.set_defaults(command=run, parser=parser)


def list_names(meanings: dict[str, str]) -> str:
    """Return names with their meanings, a line for each, in the layout of options. Long lines are wrapped."""
    column = 24
    lines = []
    for name, meaning in meanings.items():
        text = fill(meaning, WIDTH, initial_indent=" " * column, subsequent_indent=" " * column)
        fits = len(name) + 4 <= column
        lines.append(f"  {name:{column - 2}}{text.lstrip()}" if fits else f"  {name}\n{text}")
    return "\n".join(lines)


def add_output(parser: argparse.ArgumentParser, meaning: str, overwrite: str) -> None:
    """Add the options of a command that writes a file: `-o` and `--force`."""
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help=meaning)
    parser.add_argument("--force", action="store_true", help=f"replace {overwrite}")


def add_trajectory(parser: argparse.ArgumentParser) -> None:
    """Add the argument of a command that reads a trajectory."""
    parser.add_argument("trajectory", metavar="FILE", help="trajectory of gaspart (.nc)")


def config_command(command: str) -> Callable:
    """Return the function of a command that uses a workflow's config or results. The function is found by an
    entry point, because the library does not import the reproduction. Entry points of other packages are
    ignored.
    """
    ours = [entry for entry in entry_points_of("gaspart.configs") if entry.value.startswith("gaspart.")]
    return next(entry for entry in ours if entry.name == command).load()


def print_line(text: object) -> None:
    """Print a text as one line (see `visible`). Characters that the standard output cannot encode, for
    example in file names, are escaped.
    """
    line = visible(text, names=True)
    try:
        print(line)
    except UnicodeEncodeError:
        encoding = sys.stdout.encoding
        print(line.encode(encoding, "backslashreplace").decode(encoding))


def print_lines(lines: Iterable[object]) -> None:
    """Print several lines; line breaks inside a line are escaped."""
    for line in lines:
        print_line(line)


def print_note(text: str) -> None:
    """Print one line on stderr, so that it is not part of a result for scripts."""
    with suppress(OSError):  # stderr is full or closed
        print(f"gaspart: {visible(text)}", file=sys.stderr, flush=True)


def several(kind: Callable[[str], T]) -> Callable[[str], tuple[T, ...]]:
    """Return a function that converts `1` or `1,2,3` to a tuple; `kind` converts each item."""

    def read(text: str) -> tuple[T, ...]:
        try:
            return tuple(kind(part) for part in text.split(","))
        except ValueError:
            rule = (
                f"must be {'a whole number' if kind is int else 'a number'}, or several with commas between"
            )
            raise argparse.ArgumentTypeError(f"{text!r} {rule}") from None

    return read


def alone(numbers: tuple[int, ...]) -> int | tuple[int, ...]:
    """Return the item of a tuple of one number; return a longer tuple unchanged."""
    return numbers[0] if len(numbers) == 1 else numbers


# Completion of commands by a shell.


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
