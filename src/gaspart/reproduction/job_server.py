"""Server process with the modules of all jobs loaded; it runs each job in a fork.

A job of the workflow needs 0.5 to 3 s of CPU time to load its modules. A forked copy needs 0.1 s. On a single
machine, the workflow starts the server. On a cluster, and on systems that cannot fork, jobs start without it.

`workflow/scripts/_client.py` represents the job. It sends its arguments, folder, environment and standard
files to the server over a socket. It passes signals on, and ends with the exit code of the job. If the client
is killed, the job is killed. If the server is killed, all jobs are killed. The server ends when its standard
input is closed and its last job has ended. Its input is closed when the process that started it ends.
"""

from __future__ import annotations

import atexit
import ctypes
import gc
import json
import os
import selectors
import shlex
import signal
import socket
import subprocess
import sys
import tempfile
import traceback
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import NoReturn

from gaspart.interruption import SIGNALS

_PRELOADED = (
    *("snakemake.iocontainers", "xarray", "netCDF4", "scipy.optimize", "scipy.special", "scipy.stats"),
    *("matplotlib.figure", "matplotlib.mathtext", "matplotlib.backends.backend_agg"),
    *("matplotlib.backends.backend_svg", "gaspart.rendering.style", "gaspart.rendering.legibility"),
    *("gaspart.simulation", "gaspart.trajectory.run", "gaspart.trajectory.provenance", "gaspart.files"),
    *("gaspart.reproduction.claims", "gaspart.reproduction.job_time", "gaspart.reproduction.points.point"),
    *("gaspart.reproduction.points.point", "gaspart.reproduction.points.jobs"),
    *("gaspart.reproduction.jobs.arguments", "gaspart.state.initial"),
)
_PARTS = ("measure", "claims", "figure")
_WITH_PARENT = 1
"""Constant PR_SET_PDEATHSIG of Linux's prctl."""
_MOST = 1 << 16
"""Number of bytes of a request that are sent with the files; the remainder follows."""


def start(python: str, client: Path) -> str:
    """Start the server, and return the shell command that runs a script in it.

    `python` is the shell command of the interpreter. It runs scripts if there is no server.
    """
    if sys.platform != "linux":
        return python
    try:
        # only this user may open the folder, and therefore the socket
        folder = tempfile.mkdtemp(prefix="gaspart-")
    except OSError:
        return python
    path = f"{folder}/socket"
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(path)
        listener.listen(256)
        command = [*shlex.split(python), "-m", __name__, str(listener.fileno()), path]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, _search_path()))}
        server = subprocess.Popen(
            command, stdin=subprocess.PIPE, pass_fds=[listener.fileno()], env=environment
        )
    atexit.register(
        server.communicate
    )  # closes the server's input, so that it ends; its time is then counted with this process
    return f"{python} -I -S {shlex.quote(str(client))} {shlex.quote(path)}"


def _search_path() -> list[str]:
    return [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]


def serve(listener: socket.socket, path: Path) -> None:
    """Fork this process for each request.

    The function returns when the standard input is closed and all forks have ended.
    """
    dispositions = {number: signal.getsignal(number) for number in SIGNALS}
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)  # forks use them, and so does the process that started this one
    _preload()
    wake, woken = os.pipe()
    os.set_blocking(woken, False)
    signal.set_wakeup_fd(woken, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda number, frame: None)
    jobs: dict[socket.socket, int] = {}
    with selectors.DefaultSelector() as selector:
        for file in (listener, wake, 0):
            selector.register(file, selectors.EVENT_READ)
        while jobs or 0 in selector.get_map():
            for key, _ in selector.select():
                if key.fileobj is listener:
                    connection, _ = listener.accept()
                    if process := _start_process(connection, dispositions):
                        jobs[connection] = process
                        selector.register(connection, selectors.EVENT_READ)
                elif key.fileobj == wake:
                    os.read(wake, 512)
                    _end_finished(jobs, selector)
                elif key.fileobj == 0:
                    selector.unregister(0)  # nothing is ever written to the input, so it was closed
                elif (connection := key.fileobj) in jobs:
                    _pass_on(connection, jobs[connection], selector)
    path.unlink()
    path.parent.rmdir()


def _preload() -> None:
    """Load the modules that jobs need.

    A module that cannot be loaded is reported by the job that needs it.
    """
    from gaspart.kernels.compile.cache import load_numba
    from gaspart.reproduction.families.registry import module, titles

    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # a process with threads cannot be forked safely
    gc.set_threshold(1_000_000)
    load_numba(ours=True)
    families = (module(family, part) for family in titles() for part in _PARTS)
    for name in (*_PRELOADED, *families):
        with suppress(Exception):
            import_module(name)
    gc.freeze()  # otherwise garbage collection in forks would write to all objects


def _start_process(connection: socket.socket, dispositions: dict) -> int | None:
    """Fork the process of a request, and tell the client; return None if no request arrives."""
    data, files, _, _ = socket.recv_fds(connection, _MOST, 3)
    while data and not data.endswith(b"\n"):
        more = connection.recv(1 << 20)
        data = data + more if more else b""
    if len(files) < 3 or not data:
        connection.close()
        return None
    signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    process = os.fork()
    if process == 0:
        connection.close()
        _become(json.loads(data), files, dispositions)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
    for file in files:
        os.close(file)
    with suppress(OSError):
        connection.sendall(b"started\n")
    return process


def _become(request: dict, files: list[int], dispositions: dict) -> NoReturn:
    """Run the script of a request, like an interpreter that has just started."""
    code = 1
    try:
        ctypes.CDLL(None).prctl(_WITH_PARENT, signal.SIGKILL)
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        for number, handler in dispositions.items():
            signal.signal(number, handler)
        for standard, file in enumerate(files):
            os.dup2(file, standard)
        os.closerange(3, 1 << 12)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
        atexit._clear()
        os.chdir(request["folder"])
        os.environ.clear()
        os.environ.update(request["environment"])
        sys.argv = request["arguments"]
        code = _run(sys.argv[0])
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(code)


def _run(script: str) -> int:
    """Run a script as the main module, and return its exit code."""
    sys.path[0] = str(Path(script).parent)
    main = ModuleType("__main__")
    main.__file__ = script
    sys.modules["__main__"] = main
    try:
        exec(compile(Path(script).read_bytes(), script, "exec"), main.__dict__)
    except SystemExit as ended:
        if ended.code is None or isinstance(ended.code, int):
            return ended.code or 0
        print(ended.code, file=sys.stderr)
        return 1
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


def _pass_on(connection: socket.socket, process: int, selector: selectors.BaseSelector) -> None:
    """Send a job the signals that its client received; end it if its client has ended."""
    with suppress(OSError):
        numbers = connection.recv(64)
        if not numbers:
            selector.unregister(connection)
        for number in numbers or [signal.SIGKILL]:
            os.kill(process, number)


def _end_finished(jobs: dict[socket.socket, int], selector: selectors.BaseSelector) -> None:
    """Send the exit codes of ended jobs to their clients; negative codes are signals."""
    for connection, process in tuple(jobs.items()):
        ended, status = os.waitpid(process, os.WNOHANG)
        if ended:
            if connection in selector.get_map():
                selector.unregister(connection)
            with suppress(OSError):
                connection.sendall(f"{os.waitstatus_to_exitcode(status)}\n".encode())
            connection.close()
            del jobs[connection]


if __name__ == "__main__":
    serve(socket.socket(fileno=int(sys.argv[1])), Path(sys.argv[2]))
