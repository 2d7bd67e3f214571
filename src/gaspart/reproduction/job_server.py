"""Server process with the modules of all jobs loaded; it runs each job in a fork.

A job of the workflow needs 0.5 to 3 s of CPU time to load its modules. A forked copy needs 0.1 s. On a single
machine, the workflow starts the server. On a cluster, and on systems that cannot fork, jobs start without it.

`workflow/scripts/_client.py` represents the job. It sends its arguments, its standard files and the state of
its process to the server over a socket. A fork takes on this state: folder, environment, limits, niceness,
umask, processors, ignored signals. If it cannot, or if libraries were loaded in another environment, the job
starts without the server. The client passes signals on, and ends with the exit code of the job. If the client
is killed, the job is killed. If the server is killed, all jobs are killed. The server ends when its standard
input is closed and its last job has ended. Its input is closed when the process that started it ends.

The socket has an abstract name of Linux, so no file remains after a kill. Both sides check that the other
process belongs to this user, because abstract names have no permissions.
"""

from __future__ import annotations

import atexit
import ctypes
import gc
import json
import os
import resource
import secrets
import selectors
import shlex
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import traceback
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import NoReturn

from gaspart.interruption import SIGNALS
from gaspart.system import python_with_this_package

_PRELOADED = (
    *("snakemake.iocontainers", "xarray", "netCDF4", "scipy.integrate", "scipy.optimize", "scipy.spatial"),
    *("scipy.special", "scipy.stats"),
    *("matplotlib.figure", "matplotlib.mathtext", "matplotlib.backends.backend_agg"),
    *("matplotlib.backends.backend_svg", "gaspart.rendering.style", "gaspart.rendering.legibility"),
    *("gaspart.simulation", "gaspart.trajectory.run", "gaspart.trajectory.provenance", "gaspart.files"),
    *("gaspart.reproduction.claims", "gaspart.reproduction.job_time", "gaspart.reproduction.points.point"),
    *("gaspart.reproduction.points.point", "gaspart.reproduction.points.jobs"),
    *("gaspart.reproduction.jobs.arguments", "gaspart.state.initial"),
)
_WITH_PARENT = 1
"""Constant PR_SET_PDEATHSIG of Linux's prctl."""
_MOST = 1 << 16
"""Number of bytes of a request that are received at once."""
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "GOTO_NUM_THREADS")
"""Variables that give loaded libraries their number of threads, which is 1 here."""
_READ = (
    *("HOME", "XDG_", "GASPART_CACHE", "NUMBA_", "MPL", "HDF5_", "PYTHON", "LD_"),
    *("LANG", "LC_", "TZ"),
)
"""Beginnings of the names of variables that the interpreter or libraries read when they are loaded."""
_AT_START = dict(os.environ)
"""Environment of this process before it loads libraries, some of which change it."""


def start(python: str, client: Path) -> str:
    """Start the server, and return the shell command that runs a script in it. `python` is the shell command
    of the interpreter. It runs scripts if there is no server.
    """
    if sys.platform != "linux":
        return python
    name = f"gaspart-{secrets.token_hex(16)}"
    with socket.socket(socket.AF_UNIX) as listener:
        try:
            listener.bind(f"\0{name}")
        except OSError:  # a sandbox may forbid it
            return python
        listener.listen(256)
        serving = f"from {__name__} import serve; serve({listener.fileno()})"
        command = [*shlex.split(python), *python_with_this_package(serving)]
        server = subprocess.Popen(command, stdin=subprocess.PIPE, pass_fds=[listener.fileno()])
    atexit.register(
        server.communicate
    )  # closes the server's input, so that it ends; its time is then counted with this process
    return f"{python} -I -S {shlex.quote(str(client))} {name}"


class _Client:
    """Connection of a client, with the request that has arrived, and the process of the job."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self.process = 0
        self._request = b""
        self._files: list[int] = []

    def receive(self) -> int:
        """Receive a part of the request; when it is complete, start the job and return its process. Raises
        OSError if the client has ended, belongs to another user, or asks for what a fork cannot do.
        """
        data, files, _, _ = socket.recv_fds(self.connection, _MOST, 3)
        self._request += data
        self._files += files
        if not data or not is_own_process(self.connection):
            raise ConnectionResetError
        if not data.endswith(b"\n"):
            return 0
        request = json.loads(self._request)
        if len(self._files) != 3 or not _is_as_loaded(request["environment"]):
            raise ConnectionAbortedError
        signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        try:
            self.process = os.fork()
            if self.process == 0:
                _become(request, self._files, self.connection)
        finally:
            signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
        self._close_files()
        return self.process

    def pass_on(self) -> None:
        """Send the job the signals that its client received. Raises OSError if the client has ended."""
        try:
            numbers = self.connection.recv(64)
        except ConnectionResetError:  # the client was killed before it read that the job has started
            numbers = b""
        for number in numbers or [signal.SIGKILL]:
            with suppress(ProcessLookupError):
                os.kill(self.process, number)
        if not numbers:
            raise ConnectionResetError

    def close(self, code: int | None = None) -> None:
        """Send the exit code of the job, if there is one, and forget the client."""
        with suppress(OSError):
            self.connection.sendall(b"" if code is None else f"{code}\n".encode())
        self.connection.close()
        self._close_files()

    def _close_files(self) -> None:
        for file in self._files:
            os.close(file)
        self._files = []


def is_own_process(connection: socket.socket) -> bool:
    """Return True if the process at the other end of a connection belongs to this user."""
    form = "3i"  # process, user, group
    data = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, struct.calcsize(form))
    return struct.unpack(form, data)[1] == os.geteuid()


def _is_as_loaded(environment: dict[str, str]) -> bool:
    """Return True if libraries that were loaded in this environment would be as they are here."""
    here, there = (
        {name: value for name, value in variables.items() if name.startswith(_READ)}
        for variables in (_AT_START, environment)
    )
    return here == there and all(environment.get(name, "1") == "1" for name in _THREADS)


def serve(descriptor: int) -> None:
    """Fork this process for each request. The function returns when the standard input is closed and all
    forks have ended.
    """
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)  # forks use them, and so does the process that started this one
    _preload()
    wake, woken = os.pipe()
    os.set_blocking(woken, False)
    signal.set_wakeup_fd(woken, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda number, frame: None)
    jobs: dict[int, _Client] = {}
    with selectors.DefaultSelector() as selector, socket.socket(fileno=descriptor) as listener:
        for file in (listener, wake, 0):
            selector.register(file, selectors.EVENT_READ)
        while jobs or 0 in selector.get_map():
            for key, _ in selector.select():
                if key.fileobj is listener:
                    connection, _ = listener.accept()
                    selector.register(connection, selectors.EVENT_READ, _Client(connection))
                elif key.fileobj == wake:
                    os.read(wake, 512)
                    _end_finished(jobs, selector)
                elif key.fileobj == 0:
                    selector.unregister(0)  # nothing is ever written to the input, so it was closed
                elif key.fileobj in selector.get_map():
                    _answer(key.data, jobs, selector)


def _answer(client: _Client, jobs: dict[int, _Client], selector: selectors.BaseSelector) -> None:
    """Read what a client has sent, without waiting for more."""
    try:
        if client.process:
            client.pass_on()
        elif process := client.receive():
            jobs[process] = client
    except (OSError, ValueError):  # the end of the job, if there is one, is still awaited
        selector.unregister(client.connection)
        if not client.process:
            client.close()


def _preload() -> None:
    """Load the modules that jobs need. A module that cannot be loaded is reported by the job that
    needs it.
    """
    from gaspart.kernels.compile.cache import load_numba
    from gaspart.reproduction.registry import modules

    os.environ |= dict.fromkeys(_THREADS, "1")  # a process with threads cannot be forked safely
    gc.set_threshold(1_000_000)
    load_numba(ours=True)
    for name in (*_PRELOADED, *modules()):
        with suppress(Exception):
            import_module(name)
    gc.freeze()  # otherwise garbage collection in forks would write to all objects


def _become(request: dict, files: list[int], connection: socket.socket) -> NoReturn:
    """Run the script of a request, like an interpreter that has just started, and tell the client before."""
    code = 1
    try:
        ctypes.CDLL(None).prctl(_WITH_PARENT, signal.SIGKILL)
        _take_on(request)
        for standard, file in enumerate(files):
            os.dup2(file, standard)
        connection.sendall(b"started\n")
        connection.close()
        os.closerange(3, 1 << 12)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
        atexit._clear()
        code = _run(sys.argv[0])
        threading._shutdown()  # type: ignore[attr-defined]  # waits for threads of the script
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
        if code < 0:
            signal.signal(-code, signal.SIG_DFL)
            os.kill(os.getpid(), -code)
    finally:
        os._exit(code)


def _take_on(request: dict) -> None:
    """Take on the state of a client's process. Raises OSError or ValueError if this is not permitted."""
    signal.set_wakeup_fd(-1)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    for number in request["ignored"]:
        signal.signal(number, signal.SIG_IGN)
    os.chdir(request["folder"])
    os.umask(request["umask"])
    os.setpriority(os.PRIO_PROCESS, 0, request["niceness"])
    os.sched_setaffinity(0, request["processors"])
    for name, limits in request["limits"].items():
        resource.setrlimit(getattr(resource, name), tuple(limits))
    os.environ.clear()
    os.environ.update(request["environment"])
    tempfile.tempdir = None  # read again from the environment
    sys.argv = request["arguments"]


def _run(script: str) -> int:
    """Run a script as the main module, and return its exit code."""
    sys.path.insert(0, str(Path(script).parent))
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
    except KeyboardInterrupt:
        traceback.print_exc()
        return -signal.SIGINT
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


def _end_finished(jobs: dict[int, _Client], selector: selectors.BaseSelector) -> None:
    """Send the exit codes of ended jobs to their clients; negative codes are signals."""
    for process, client in tuple(jobs.items()):
        ended, status = os.waitpid(process, os.WNOHANG)
        if ended:
            if client.connection in selector.get_map():
                selector.unregister(client.connection)
            client.close(os.waitstatus_to_exitcode(status))
            del jobs[process]
