"""Making the points of a sweep: in this process, or in several.

A point that cannot be made costs no other one: the reason is kept in place of its trajectories. What concerns
the files of all, such as a full disk or a trajectory of another sweep, ends the sweep instead.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from multiprocessing import connection
from pathlib import Path
from signal import SIGTERM, raise_signal

from gaspart.errors import SceneError, SimulationError
from gaspart.files import only_process
from gaspart.interruption import deferred, exit_on_signals
from gaspart.kernels.compile.loading import load_numba
from gaspart.reproduction.jobs.replicas import replica_paths, write_replicas
from gaspart.reproduction.jobs.simulate import recipes, record
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.points.variants import compile_kernels, compile_task, variant
from gaspart.system import POSIX

_LOOK = 0.1  # seconds between two looks at signals while processes run
_PATIENCE = 60.0  # seconds for a process to write a checkpoint before it is killed
_SIGNALLED = (130, 143)  # exit codes of a process that a signal has ended after a checkpoint


def make_all(
    points: Sequence[Point], workers: int, overwrite: bool, finished: Callable[[Point, str], None]
) -> None:
    """Make the trajectories of all points; finished(point, reason) is called for each, with the reason why it
    could not be made, or "". Those whose trajectories exist come first: a conflict is then found before
    anything is run. Raises SceneError for files that cannot be written or are of another sweep."""
    ordered = sorted(points, key=lambda point: not Path(point.path).exists())
    if workers == 1:
        for point in ordered:
            finished(point, make(point, overwrite))
        return
    if not POSIX:
        raise SceneError("workers", workers, "more than one process needs Linux or macOS; workers=1")
    for one in {variant(point): point for point in ordered}.values():  # or each process would compile them
        with suppress(SceneError, SimulationError):  # of its own point alone
            compile_kernels(compile_task(one))
    _in_processes(ordered, workers, overwrite, finished)


def make(point: Point, overwrite: bool) -> str:
    """Make the trajectories of a point, or check that those in its folder are these; returns the reason why
    it could not be done, or "". Raises SceneError for files; see `make_all`."""
    folder = Path(point.path)
    try:
        wanted = recipes(**point.arguments)
        with only_process(folder, wait=True):
            if not folder.exists():
                write_replicas(record, wanted, folder, None, overwrite)
                return ""
            for path, recipe in zip(replica_paths(folder, len(wanted)), wanted, strict=True):
                record(recipe, path, overwrite)
    except OSError as error:
        rule = f"cannot be written: {error.strerror}"
        raise SceneError(f"{point.experiment}[{point.name}].path", str(folder), rule) from None
    except SceneError as error:
        if error.key == "path":
            raise error.inside(f"{point.experiment}[{point.name}]") from None
        return str(error)
    except SimulationError as error:
        return str(error)
    except MemoryError:
        return "there is not enough memory"
    return ""


class _Process:
    """A process that makes one point. Unlike those of a pool it does not run the caller's script again, and
    signals of the terminal do not reach it: it ends when it is told to, or when this process has ended."""

    def __init__(self, point: Point, overwrite: bool) -> None:
        self.point = point
        command = [sys.executable, "-m", "gaspart.reproduction.sweep_points"]
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe, start_new_session=True)
        given = pickle.dumps((point.to_dict(), overwrite))
        with suppress(BrokenPipeError):  # it has ended, for a reason that its exit code states
            assert self._process.stdin
            self._process.stdin.write(b"%d\n" % len(given) + given)  # open until it ends
            self._process.stdin.flush()

    @property
    def output(self) -> int:
        """The descriptor of what it writes, which is readable when it has ended."""
        assert self._process.stdout
        return self._process.stdout.fileno()

    def result(self) -> tuple[int, str]:
        """Its exit code, and what `make` returned. Raises what that raised."""
        assert self._process.stdin and self._process.stdout
        written = self._process.stdout.read()
        code = self._process.wait()
        self._process.stdout.close()
        with suppress(BrokenPipeError):
            self._process.stdin.close()
        if code:
            return code, f"its process ended with code {code}"
        found = pickle.loads(written)
        if isinstance(found, SceneError):
            raise found
        return 0, found

    def end(self) -> None:
        """Let it write a checkpoint and end."""
        self._process.terminate()

    def wait(self) -> None:
        """Wait for its end."""
        try:
            self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
        with suppress(SceneError):
            self.result()


def _in_processes(
    points: Sequence[Point], workers: int, overwrite: bool, finished: Callable[[Point, str], None]
) -> None:
    """`make` in processes, of which so many run at a time. A signal takes effect when all have ended after a
    checkpoint; where the caller's handler returns, they are begun again."""
    waiting: list[Point] = list(reversed(points))
    running: list[_Process] = []
    with deferred() as signals:
        signals.unsaved = True
        try:
            while waiting or running:
                while waiting and len(running) < workers:
                    running.append(_Process(waiting.pop(), overwrite))
                ended = connection.wait([process.output for process in running], _LOOK)
                for process in [one for one in running if one.output in ended]:
                    running.remove(process)
                    code, reason = process.result()
                    if code in _SIGNALLED and signals.pending is not None:
                        waiting.append(process.point)
                    else:
                        finished(process.point, reason)
                if signals.pending is not None:
                    waiting += [process.point for process in running]
                    _end(running)
                    signals.deliver()
        finally:
            _end(running)


def _end(running: list[_Process]) -> None:
    """End all processes."""
    for process in running:
        process.end()
    for process in running:
        process.wait()
    running.clear()


def _serve() -> None:
    """Make the point that the standard input states; write the reason that `make` returns, or its error."""
    exit_on_signals(announce=lambda line: None)  # the process that began this one says so
    given = pickle.loads(sys.stdin.buffer.read(int(sys.stdin.buffer.readline())))
    threading.Thread(target=_end_with_parent, daemon=True).start()
    load_numba(ours=True)
    values, overwrite = given
    found: str | SceneError
    try:
        found = make(Point.from_dict(values), overwrite)
    except SceneError as error:
        found = error
    pickle.dump(found, sys.stdout.buffer)


def _end_with_parent() -> None:
    """End after a checkpoint when the process that began this one has ended, however it did: its end of the
    standard input is then closed."""
    while os.read(0, 64):
        pass
    raise_signal(SIGTERM)


if __name__ == "__main__":
    _serve()
