"""What the commands' arguments have in common."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from textwrap import fill
from typing import Any, NoReturn, TypeAlias, TypeVar

from gaspart.validation import number

T = TypeVar("T")
Commands: TypeAlias = "argparse._SubParsersAction[Parser]"
"""What a command adds itself to."""


class UsageError(Exception):
    """What argparse has to complain of."""


class Parser(argparse.ArgumentParser):
    """Raises what argparse would print, takes options in full only, and leaves lines of text as they are."""

    def __init__(self, **settings: Any) -> None:
        settings["description"] = fill(settings["description"], width=100)
        super().__init__(allow_abbrev=False, formatter_class=argparse.RawDescriptionHelpFormatter, **settings)

    def error(self, message: str) -> NoReturn:
        """Raise what argparse would print and exit for."""
        raise UsageError(message)


def real(**limits: float) -> Callable[[str], float]:
    """What reads a finite number within limits, those of `gaspart.validation.number`: above, least, most."""
    return _reader(float, "a finite number", limits)


def whole(**limits: float) -> Callable[[str], int]:
    """What reads a whole number within such limits."""
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


def add_output(parser: argparse.ArgumentParser, what: str, overwrite: str) -> None:
    """Add the options of a command that writes a result: `-o`, and `--force` to replace an older one."""
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help=what)
    parser.add_argument("--force", action="store_true", help=f"replace {overwrite}")


def say(text: object) -> None:
    """Print a line; what the standard output cannot encode, as in the name of a file, is escaped."""
    encoding = sys.stdout.encoding or "utf-8"
    print(str(text).encode(encoding, "backslashreplace").decode(encoding))


def several(kind: Callable[[str], T]) -> Callable[[str], tuple[T, ...]]:
    """What reads `1` or `1,2,3` as a tuple of what `kind`, a type or a reader, makes of each part."""

    def read(text: str) -> tuple[T, ...]:
        try:
            return tuple(kind(part) for part in text.split(","))
        except ValueError:
            rule = (
                f"must be {'a whole number' if kind is int else 'a number'}, or several with commas between"
            )
            raise argparse.ArgumentTypeError(f"{text!r} {rule}") from None

    return read
