"""The entry point of the command line: `gaspart`, and `python -m gaspart`.

What has to be in place before anything large is imported: signals, and three standard streams.
"""

import os
import signal
import sys


def main() -> int:
    """Carry out the command line of this process; returns the exit code."""
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _exit)
    from gaspart.interruption import exit_on_signals

    _open_closed_streams()
    exit_on_signals()
    from gaspart.cli import main as carry_out

    return carry_out()


def _exit(signum: int, frame: object) -> None:
    """The handler of the first milliseconds."""
    os._exit(128 + signum)


def _open_closed_streams() -> None:
    """Give a process that was started with closed streams (`2>&-`) the null device in their place.

    Otherwise the next file to be opened, a trajectory say, would take the number of stderr, and with it what
    libraries print there.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number, which is this one
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115
    # names of files that are no UTF-8 are printed as the bytes that they are
    from io import TextIOWrapper

    if isinstance(sys.stdout, TextIOWrapper) and sys.stdout.encoding.lower() == "utf-8":
        sys.stdout.reconfigure(errors="surrogateescape")


if __name__ == "__main__":
    sys.exit(main())
