"""What the commands' arguments have in common."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from textwrap import fill
from typing import Any, NoReturn, TypeAlias

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


def several(kind: type) -> Callable[[str], tuple]:
    """What reads `1` or `1,2,3` as a tuple of int or float."""

    def read(text: str) -> tuple:
        try:
            return tuple(kind(part) for part in text.split(","))
        except ValueError:
            rule = (
                f"must be {'a whole number' if kind is int else 'a number'}, or several with commas between"
            )
            raise argparse.ArgumentTypeError(f"{text!r} {rule}") from None

    return read
