"""Progress of a run on one line of a terminal."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gaspart.trajectory.recording import Progress


def progress(quiet: bool) -> Progress | None:
    """A function that prints the progress of a run on one line; None if quiet or without a terminal."""
    if quiet or not sys.stderr.isatty():
        return None
    begun: tuple[float, float, int] | None = None

    def show(reached: float, duration: float, collisions: int) -> None:
        nonlocal begun
        now = time.monotonic()
        if begun is None:  # a resumed run begins in the middle
            begun = now, reached, collisions
            return
        took = now - begun[0]
        rate = (reached - begun[1]) / took
        left = f"{clock((duration - reached) / rate)} left" if rate > 0.0 else ""
        speed = f"{(collisions - begun[2]) / took:.3g} collisions/s"
        print(
            f"{clear_line()}{reached / duration:6.1%}  {speed}  {left}", end="", file=sys.stderr, flush=True
        )

    return show


def clear_line() -> str:
    """Control characters that clear the line of progress; empty without a terminal."""
    return "\r\033[K" if sys.stderr.isatty() else ""


def clock(seconds: float) -> str:
    """Hours, minutes and seconds."""
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{seconds:02d}"
