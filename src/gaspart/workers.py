"""Work that is shared by several processes or threads.

Each process calls a function that writes resumable files. Unlike processes of a pool, these processes do not
run the caller's script again, and do not receive signals of the terminal. Each process writes a checkpoint
and ends when it receives a signal, or when its parent process has ended.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import Pipe, connection
from signal import SIGTERM
from typing import Any

from gaspart.errors import SceneError, SimulationError
from gaspart.interruption import defer_signals, exit_on_signals
from gaspart.system import python_with_this_package

_LOOK = 0.1  # seconds between two checks for signals while processes run
_PATIENCE = 60.0  # seconds that a process has for its checkpoint before it is killed
_SIGNALLED = (130, 143)  # exit codes of a process that ended at a signal after its checkpoint


@dataclass(frozen=True)
class Lost:
    """Result of a process that ended without a result: its exit code."""

    code: int

    def __str__(self) -> str:
        return f"its process ended with code {self.code}"


def in_threads(function: Callable[[Any], Any], items: Iterable[Any], threads: int) -> list[Any]:
    """Return the results of a function for all items, in their order. Threads speed up functions that mostly
    run kernels, because kernels release the interpreter lock.
    """
    if threads == 1:
        return [function(item) for item in items]
    with ThreadPoolExecutor(threads) as executor:
        return list(executor.map(function, items))


def in_processes(
    function: Callable[..., Any],
    calls: Sequence[tuple],
    workers: int,
    finished: Callable[[int, Any], None],
    received: Callable[[int, Any], None] | None = None,
) -> None:
    """Call a function of a module in several processes at the same time. The call is function(send,
    *arguments). A signal takes effect after all calls have written a checkpoint and ended. If the caller's
    signal handler returns, the calls are started again. A SceneError or SimulationError of a call is raised
    after all other calls have ended. `calls`: arguments of each call. `workers`: number of processes at the
    same time. `finished`: called as finished(n, result) when call n has returned, or when its process is
    `Lost`. `received`: called as received(n, message) when a process has sent a message with send(message).
    """
    waiting = list(reversed(range(len(calls))))
    running: list[_Worker] = []
    with defer_signals() as signals:
        signals.unsaved = True
        try:
            while waiting or running:
                while waiting and len(running) < workers:
                    number = waiting.pop()
                    running.append(_Worker(number, function, calls[number]))
                ready = connection.wait([worker.connection for worker in running], _LOOK)
                for worker in [candidate for candidate in running if candidate.connection in ready]:
                    if worker.receive(received):
                        continue
                    running.remove(worker)
                    result = worker.result()
                    if isinstance(result, Lost) and result.code in _SIGNALLED and signals.pending is not None:
                        waiting.append(worker.number)
                    else:
                        finished(worker.number, result)
                if signals.pending is not None:
                    waiting += [worker.number for worker in running]
                    _end(running)
                    signals.deliver()
        finally:
            _end(running)


class _Worker:
    """Process that performs one call.

    connection : connection to the process, readable when it has sent a message or ended
    """

    def __init__(self, number: int, function: Callable[..., Any], arguments: tuple) -> None:
        self.number = number
        self.connection, there = Pipe()
        serving = f"from {__name__} import serve; serve({there.fileno()})"
        command = [sys.executable, *python_with_this_package(serving)]
        self._process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, pass_fds=[there.fileno()], start_new_session=True
        )
        there.close()
        self._results: list[Any] = []
        with suppress(BrokenPipeError):  # the process has ended; its exit code states the reason
            self.connection.send_bytes(pickle.dumps((function, arguments)))

    def receive(self, received: Callable[[int, Any], None] | None) -> bool:
        """Receive a message of the process; return False if it has ended."""
        try:
            is_result, content = self.connection.recv()
        except (EOFError, OSError):
            return False
        if is_result:
            self._results.append(content)
        elif received:
            received(self.number, content)
        return True

    def result(self) -> Any:
        """Return the result of the call after the process has ended, or raise its exception."""
        code = self._process.wait()
        self.connection.close()
        if code or not self._results:
            return Lost(code)
        if isinstance(self._results[0], SceneError | SimulationError):
            raise self._results[0]
        return self._results[0]

    def end(self) -> None:
        """Make the process write a checkpoint and end."""
        self._process.terminate()

    def wait(self) -> None:
        """Wait until the process has ended."""
        try:
            self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self.connection.close()


def _end(running: list[_Worker]) -> None:
    """End all processes."""
    for worker in running:
        worker.end()
    for worker in running:
        worker.wait()
    running.clear()


def serve(descriptor: int) -> None:
    """Perform the call that is received, and send its result or its error."""
    exit_on_signals(announce=lambda line: None)  # the parent process reports it
    other, sending = connection.Connection(descriptor), threading.Lock()
    function, arguments = pickle.loads(other.recv_bytes())
    threading.Thread(target=_end_with, args=(other,), daemon=True).start()

    def send(is_result: bool, content: Any) -> None:
        with sending:
            other.send((is_result, content))

    try:
        result = function(lambda message: send(False, message), *arguments)
    except (SceneError, SimulationError) as error:
        result = error
    send(True, result)


def _end_with(other: connection.Connection) -> None:
    """End after a checkpoint when the parent process has ended for any reason."""
    with suppress(EOFError, OSError):
        other.recv_bytes()  # there are no further messages
    os.kill(os.getpid(), SIGTERM)
