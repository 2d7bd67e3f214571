"""SIGINT and SIGTERM: when they take effect, and the actions of the process before it ends.

An exception raised by a signal handler appears at any point of the program. If a compiled kernel is just
returning its result, the kernel then fails with a SystemError. Therefore no handler of this module raises an
exception.

`exit_on_signals` is for processes that belong to gaspart: the command line and the jobs of the workflow. In
these processes a thread waits for the signal, so imports, compilers and kernels need not return first.

`defer_signals` is for work whose state must be saved. In a process of gaspart, a signal then waits until the
state has been saved. In any other program, such as a notebook, the program's own handler is called
afterwards.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from contextlib import contextmanager, suppress

from gaspart.errors import visible

TYPE_CHECKING = False
if TYPE_CHECKING:  # no slow imports, because Ctrl-C gives a traceback until the handlers are set
    from collections.abc import Callable, Iterator
    from pathlib import Path
    from typing import NoReturn

SIGNALS = (signal.SIGINT, signal.SIGTERM)
_TOGETHER = 1.0  # in seconds


class Deferral:
    """Block of work during which signals wait."""

    def __init__(self) -> None:
        self.pending: int | None = None
        self.since = 0.0
        self.unsaved = False
        self.handlers: dict[int, Callable | int] = {}

    def receive(self, signum: int, frame: object = None) -> None:
        """Store a signal; this is the handler during the work."""
        self.pending, self.since = signum, time.monotonic()

    def deliver(self) -> None:
        """Deliver the waiting signal, if there is one. A process of gaspart then ends. Elsewhere the
        program's own handler is called: Python's handler raises KeyboardInterrupt, and SIGTERM ends the
        process unless it is handled. If the handler returns, this method also returns, and the work
        continues.
        """
        signum, self.pending = self.pending, None
        if signum is None:
            return
        if _process.watched:
            _exit(signum)
        for number, handler in self.handlers.items():
            signal.signal(number, handler)
        try:
            signal.raise_signal(signum)
        finally:
            for number in self.handlers:
                signal.signal(number, self.receive)


class _Process:
    """State shared with the watching thread."""

    def __init__(self) -> None:
        self.watched = False
        self.deferral: Deferral | None = None
        self.note = ""
        self.announce: Callable[[str], None] | None = None
        self.scratch: set[Path] = set()
        self.lock, self.exiting = threading.Lock(), threading.Lock()


_process = _Process()


def exit_on_signals(announce: Callable[[str], None] | None = None) -> None:
    """End this process at SIGINT and SIGTERM with exit code 130 or 143 and one line. No scratch files are
    left. A second call replaces `announce`. Signals that are ignored remain ignored, for example in a
    background process of a shell script. Only the main thread may call this function. `announce`: function
    that prints the line, by default to stderr.
    """
    _process.announce = announce
    if _process.watched:
        return
    _process.watched = True
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(reader,), name="signals", daemon=True).start()
    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _defer_to_thread)
            signal.siginterrupt(number, False)  # some C libraries do not repeat interrupted calls


def _defer_to_thread(signum: int, frame: object) -> None:
    """Do nothing, because the interpreter has already written the signal number to the pipe."""


def _watch(reader: int) -> None:
    while numbers := os.read(reader, 64):
        for signum in numbers:
            if signum in SIGNALS and not _defer(signum):
                _exit(signum)


def _defer(signum: int) -> bool:
    """Return True if a signal can wait. A second signal takes effect at once, because files are always
    resumable. An exception is a second signal that arrives together with the first one, for example from a
    terminal and a parent process.
    """
    with _process.lock:
        deferral = _process.deferral
        if deferral is None or not deferral.unsaved:
            return False
        if deferral.pending is None:
            deferral.receive(signum)
        return time.monotonic() - deferral.since < _TOGETHER


def _exit(signum: int) -> NoReturn:
    """End the process, from any thread."""
    _process.exiting.acquire()  # never released, so that only the first of two threads ends the process
    for path in tuple(_process.scratch):
        with suppress(OSError):
            if path.is_dir():
                import shutil  # loaded already, with the folder

                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink()
    announce = _process.announce or _announce
    with suppress(OSError, ValueError):
        announce(describe_interruption(signum))
    os._exit(128 + signum)


def _announce(text: str) -> None:
    """Print a line on stderr without locks, because the main thread may hold them."""
    clear = "\r\033[K" if os.isatty(2) else ""
    os.write(2, f"{clear}gaspart: {text}\n".encode(errors="surrogateescape"))


def describe_interruption(signum: int = signal.SIGINT) -> str:
    """Return a line that states the interruption and the work that is saved."""
    how = "interrupted" if signum == signal.SIGINT else "terminated"
    return f"{how}; {_process.note}" if _process.note else how


def set_note(text: str) -> None:
    """Set the text about saved work in the line at an interruption."""
    _process.note = visible(text)


@contextmanager
def scratch_file(path: Path) -> Iterator[None]:
    """Remove a scratch file, or a folder, if a signal ends the process within this block."""
    _process.scratch.add(path)
    try:
        yield
    finally:
        _process.scratch.discard(path)


@contextmanager
def scratch_folder() -> Iterator[Path]:
    """Create a folder, and remove it at the end of this block or when a signal ends the process."""
    from pathlib import Path
    from tempfile import TemporaryDirectory

    with TemporaryDirectory(prefix="gaspart-") as name, scratch_file(Path(name)):
        yield Path(name)


@contextmanager
def prevent_interruption() -> Iterator[None]:
    """Defer signals to the end of this block if their handlers might raise within it. This is for other
    programs, such as a notebook. In a process of gaspart, signals still end the process at once.
    """
    if _process.watched:
        yield
        return
    with defer_signals():
        yield


@contextmanager
def defer_signals() -> Iterator[Deferral]:
    """Defer signals until `Deferral.deliver` or the end of the block. Nothing is changed outside of the main
    thread, where Python calls no handlers, and for handlers that were not installed by Python.
    """
    deferral = Deferral()
    if _process.watched:
        with _process.lock:
            _process.deferral = deferral
    elif threading.current_thread() is threading.main_thread():
        for number in SIGNALS:
            handler = signal.getsignal(number)
            if handler is not None and handler is not signal.SIG_IGN:
                deferral.handlers[number] = handler
                signal.signal(number, deferral.receive)
    try:
        yield deferral
    finally:
        with _process.lock:
            _process.deferral = None
        for number, handler in deferral.handlers.items():
            signal.signal(number, handler)
        deferral.handlers.clear()
        deferral.deliver()
