"""Entry point of the command line: `gaspart`, and `python -m gaspart`.

This module prepares signals and the three standard streams before any large import.
"""

import os
import signal
import sys
from io import TextIOWrapper


def main() -> int:
    """Run the command line of this process, and return the exit code."""
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _exit)
    from gaspart.interruption import exit_on_signals

    closed = _open_closed_streams()
    exit_on_signals()
    from gaspart.cli import main as carry_out
    from gaspart.cli import show_warnings_in_a_line

    show_warnings_in_a_line()
    return carry_out(without_output=1 in closed)


def _exit(signum: int, frame: object) -> None:
    """Handle a signal in the first milliseconds, before `gaspart.interruption` is imported."""
    pipe = signal.set_wakeup_fd(-1)
    if pipe != -1:  # `gaspart.interruption` has taken over at this moment, and prints the line
        signal.set_wakeup_fd(pipe)
        os.write(pipe, bytes([signum]))
        return
    os.write(2, b"gaspart: interrupted\n" if signum == signal.SIGINT else b"gaspart: terminated\n")
    os._exit(128 + signum)


def _open_closed_streams() -> set[int]:
    """Open the null device in place of closed standard streams (`2>&-`); return their numbers. Otherwise the
    next opened file, such as a trajectory, would get the number of stderr, and would receive the output of
    libraries.
    """
    closed = set()
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            closed.add(number)
            os.open(os.devnull, os.O_RDWR)  # returns the lowest free number, which is this one
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115
    # file names that are not UTF-8 are printed as their bytes
    if isinstance(sys.stdout, TextIOWrapper) and sys.stdout.encoding.lower() == "utf-8":
        sys.stdout.reconfigure(errors="surrogateescape")
    return closed


if __name__ == "__main__":
    sys.exit(main())
