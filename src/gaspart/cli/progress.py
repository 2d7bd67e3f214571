"""Display of progress on one line of a terminal."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from gaspart.errors import visible

if TYPE_CHECKING:
    from gaspart.trajectory.recording import Progress


_PATIENCE = 2.0
"""Time in seconds after which `waiting` begins to show the present work."""


@contextmanager
def waiting(text: str, quiet: bool = False) -> Iterator[Callable[[], None]]:
    """Show `text` and the elapsed time during a `with` block that lasts over 2 s. Yields a function that ends
    the display, for a block that reports its own progress afterwards.
    """
    ended = threading.Event()
    if quiet or not sys.stderr.isatty():
        yield ended.set
        return
    begun, ticker = time.monotonic(), threading.Thread(target=lambda: tick(), daemon=True)

    def tick() -> None:
        pause = _PATIENCE
        while not ended.wait(pause):
            show_line(f"{text} {clock(time.monotonic() - begun)}")
            pause = 1.0

    def end() -> None:
        if not ended.is_set():
            ended.set()
            ticker.join()
            show_line("")

    ticker.start()
    try:
        yield end
    finally:
        end()


def picture_progress() -> Callable[[int, int], None] | None:
    """Return a function that shows the number of finished pictures and the remaining time. Returns None if
    the output is not a terminal.
    """
    if not sys.stderr.isatty():
        return None
    begun = time.monotonic()

    def show(done: int, total: int) -> None:
        took = time.monotonic() - begun
        if took > _PATIENCE:
            show_line(f"picture {done} of {total}  {clock(took / done * (total - done))} left")

    return show


def progress(
    quiet: bool, started: Callable[[], None] | None = None, remark: Callable[[], str] = str
) -> Progress | None:
    """Return a function that shows the progress of a run. Returns None if the output is not a terminal, or if
    `quiet` is True. `started`: function that is called at the first report. `remark`: function that returns
    text for the end of the line.
    """
    if quiet or not sys.stderr.isatty():
        return None
    begun: tuple[float, float, int] | None = None

    def show(reached: float, duration: float, collisions: int) -> None:
        nonlocal begun
        if started is not None:
            started()
        now = time.monotonic()
        if begun is None:  # a resumed run starts in the middle
            begun = now, reached, collisions
            return
        took = now - begun[0]
        rate = (reached - begun[1]) / took
        remaining = f"{clock((duration - reached) / rate)} left" if rate > 0.0 else ""
        speed = f"{(collisions - begun[2]) / took:.3g} collisions/s"
        show_line(f"{reached / duration:6.1%}  {speed}  {remaining}{remark()}")

    return show


def show_line(text: str) -> None:
    """Replace the progress line."""
    print(f"{clear_line()}{visible(text)}", end="", file=sys.stderr, flush=True)


def clear_line() -> str:
    """Return control characters that clear the progress line; "" without a terminal."""
    return "\r\033[K" if sys.stderr.isatty() else ""


def clock(seconds: float) -> str:
    """Format a time as hours, minutes and seconds."""
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{seconds:02d}"
