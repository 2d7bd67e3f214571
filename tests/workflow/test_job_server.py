"""Jobs as copies of a process that has loaded their modules, beside jobs that start by themselves."""

import json
import os
import runpy
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from workspace import ROOT

from gaspart.reproduction import job_server

pytestmark = [
    pytest.mark.workflow,
    pytest.mark.skipif(sys.platform != "linux", reason="processes are copied on Linux only"),
]
START = f"""
import sys
from pathlib import Path
from gaspart.reproduction import job_server
print(job_server.start(sys.executable, Path({str(ROOT / "workflow/scripts/_client.py")!r})), flush=True)
sys.stdin.read()
"""
CAUGHT = {"capture_output": True, "text": True}
LONG = "a" * 120  # the path of a socket may have 107 bytes
SLEEP = "import os, time; print(os.getpid(), flush=True); time.sleep(60)"


class Server:
    """A process that has started a server, as Snakemake does, and the command of a job."""

    def __init__(self, folder, **named):
        self.folder = folder
        command = [sys.executable, "-P", "-c", START]
        self.parent = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, **named
        )
        self.command = self.parent.stdout.readline().strip()
        children = Path(f"/proc/{self.parent.pid}/task/{self.parent.pid}/children")
        self.process = int(children.read_text())

    def run(self, code, *arguments, shell="", **named):
        """The finished process of a job with this script."""
        script = self.folder / "script.py"
        script.write_text(code)
        command = f"{shell} {self.command} {script} {' '.join(arguments)}"
        return subprocess.run(["bash", "-c", command], **CAUGHT, **named)

    def begin(self, code):
        """The client of a job that runs, and the job's process."""
        script = self.folder / "long.py"
        script.write_text(code)
        command = f"exec {self.command} {script}"
        client = subprocess.Popen(command, shell=True, stdout=subprocess.PIPE, text=True)
        return client, int(client.stdout.readline())


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    folder = tmp_path_factory.mktemp("server")
    (folder / "queue.py").write_text("raise SystemExit('this file was executed')")
    (folder / LONG).mkdir()
    (folder / "scripts").mkdir()
    started = Server(folder / "scripts", cwd=folder, env={**os.environ, "TMPDIR": str(folder / LONG)})
    yield started
    started.parent.communicate()


@pytest.fixture
def mortal(tmp_path):
    """A server of one test."""
    started = Server(tmp_path)
    yield started
    started.parent.communicate()


def is_gone(process, seconds=30.0):
    """Return True if a process ends within a time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            if Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z":
                return True
        except FileNotFoundError:
            return True
        time.sleep(0.02)
    return False


def test_a_job_has_its_own_arguments_folder_environment_files_and_exit_code(server, tmp_path):
    code = """
import os, sys
loaded = "xarray" in sys.modules
print(__name__, sys.argv[1:], os.getcwd(), os.environ.get("MINE"), sys.stdin.read(), loaded, os.getppid())
print("aside", file=sys.stderr)
sys.exit(3)
"""
    named = {"cwd": tmp_path, "env": {**os.environ, "MINE": "a\nb"}, "input": "given"}
    done = server.run(code, "x", "'y z'", **named)
    assert done.returncode == 3 and done.stderr == "aside\n"
    assert done.stdout == f"__main__ ['x', 'y z'] {tmp_path} a\nb given True {server.process}\n"
    assert server.run("raise ValueError('no')").stderr.endswith("ValueError: no\n")
    assert [server.run(one).returncode for one in ("1 / 0", "", "import sys; sys.exit('no')")] == [1, 0, 1]
    ended = server.run("import atexit, sys; atexit.register(print, 'last'); print('first')")
    assert ended.stdout == "first\nlast\n"
    alone = server.run("import os; print(os.environ.get('MINE'))")
    assert alone.stdout == "None\n"  # nothing is left of the first job


def test_signals_reach_the_job_and_kills_end_it(server):
    announced = """
import os, time
from gaspart.interruption import exit_on_signals
exit_on_signals(lambda text: print(text, flush=True))
print(os.getpid(), flush=True)
time.sleep(60)
"""
    for number, code, said in ((signal.SIGTERM, 143, "terminated\n"), (signal.SIGINT, 130, "interrupted\n")):
        client, process = server.begin(announced)
        client.send_signal(number)
        assert (client.communicate()[0], client.returncode) == (said, code)
        assert is_gone(process)
    client, process = server.begin(SLEEP)
    client.send_signal(signal.SIGTERM)  # nobody has a handler
    client.communicate()
    assert client.returncode == -signal.SIGTERM and is_gone(process)
    client, process = server.begin(SLEEP)
    client.kill()
    assert is_gone(process)
    client.communicate()
    client, process = server.begin(SLEEP)
    os.kill(process, signal.SIGKILL)  # as when memory is short
    client.communicate()
    assert client.returncode == -signal.SIGKILL


def test_without_a_server_jobs_start_by_themselves_and_none_outlives_it(mortal):
    client, process = mortal.begin(SLEEP)
    os.kill(mortal.process, signal.SIGKILL)
    assert is_gone(process)
    client.communicate()
    assert client.returncode == 1
    done = mortal.run("import sys; print('xarray' in sys.modules)")
    assert (done.stdout, done.returncode) == ("False\n", 0)


def test_the_server_ends_with_the_process_that_started_it_after_its_jobs(mortal, tmp_path):
    client, _ = mortal.begin("import os, time; print(os.getpid(), flush=True); time.sleep(2); print('done')")
    mortal.parent.kill()
    assert client.communicate()[0] == "done\n" and client.returncode == 0
    assert is_gone(mortal.process)


STATE = """
import os, resource, signal, sys, tempfile
print(os.umask(0), os.nice(0), os.sched_getaffinity(0), resource.getrlimit(resource.RLIMIT_NOFILE),
      resource.getrlimit(resource.RLIMIT_FSIZE), signal.getsignal(signal.SIGTERM), tempfile.gettempdir())
print("xarray" in sys.modules)
"""


def test_a_job_has_the_limits_umask_niceness_processors_and_ignored_signals_of_its_client(server, tmp_path):
    narrow = min(os.sched_getaffinity(0))
    mine = f"umask 027; ulimit -n 300 -f 4000; trap '' TERM; export TMPDIR={tmp_path}; "
    mine += f"taskset -c {narrow} nice -n 5"
    (tmp_path / "state.py").write_text(STATE)
    by_server, alone = (
        subprocess.run(
            ["bash", "-c", f"{mine} {command} {tmp_path / 'state.py'}"], **CAUGHT
        ).stdout.splitlines()
        for command in (server.command, sys.executable)
    )
    assert by_server[0] == alone[0] and alone[0].startswith(f"{0o27} 5 {{{narrow}}} (300, 300)")
    assert (by_server[1], alone[1]) == ("True", "False")  # one had all modules, without importing them


def test_a_job_ends_like_an_interpreter(server):
    interrupt = "import os, signal; os.kill(os.getpid(), signal.SIGINT); print('not reached')"
    ended = server.run(interrupt, shell="exec")
    assert (
        ended.returncode == -signal.SIGINT
        and ended.stdout == ""
        and ended.stderr.endswith("KeyboardInterrupt\n")
    )
    later = (
        "import threading, time; threading.Thread(target=lambda: (time.sleep(0.2), print('done'))).start()"
    )
    assert server.run(later).stdout == "done\n"


def test_what_was_loaded_in_another_environment_is_loaded_again(server):
    code = "import sys; print('xarray' in sys.modules)"
    for name, value in (("NUMBA_NUM_THREADS", "1"), ("OMP_NUM_THREADS", "2"), ("LC_ALL", "POSIX")):
        assert server.run(code, env={**os.environ, name: value}).stdout == "False\n"
    assert server.run(code, env={**os.environ, "OMP_NUM_THREADS": "1"}).stdout == "True\n"


def test_clients_that_send_nothing_or_a_part_stop_no_other_and_leave_no_descriptor(server):
    descriptors = Path(f"/proc/{server.process}/fd")
    server.run("print('ran')")  # the first job loads what stays open
    before = min(len(list(descriptors.iterdir())) for _ in range(50) if not time.sleep(0.02))
    name = "\0" + server.command.split()[-1]
    stuck = [socket.socket(socket.AF_UNIX) for _ in range(4)]
    for connection in stuck:
        connection.connect(name)
    for connection, part in zip(stuck[1:], (b"{", b'{"folder"', b"no json\n"), strict=True):
        socket.send_fds(connection, [part], [0, 1, 2])
    assert server.run("print('ran')").stdout == "ran\n"
    for connection in stuck:
        connection.close()
    assert server.run("print('ran')").stdout == "ran\n"
    end = time.monotonic() + 10.0  # the server closes what is left when it reads next
    while len(list(descriptors.iterdir())) > before and time.monotonic() < end:
        time.sleep(0.05)
    assert len(list(descriptors.iterdir())) == before


def test_a_client_that_is_killed_at_once_takes_its_job_along(server, tmp_path):
    """The client has not read that its job has started."""
    script = tmp_path / "script.py"
    script.write_text("import os, time; open('process', 'w').write(str(os.getpid())); time.sleep(60)")
    client = runpy.run_path(str(ROOT / "workflow/scripts/_client.py"))
    with socket.socket(socket.AF_UNIX) as connection:
        connection.connect("\0" + server.command.split()[-1])
        request = json.loads(client["describe_process"]([str(script)])) | {"folder": str(tmp_path)}
        socket.send_fds(connection, [f"{json.dumps(request)}\n".encode()], [0, 1, 2])
        while not (tmp_path / "process").exists() or not (tmp_path / "process").read_text():
            time.sleep(0.02)
    assert is_gone(int((tmp_path / "process").read_text()))


def test_processes_of_other_users_are_refused(monkeypatch):
    here, there = socket.socketpair()
    with here, there:
        assert job_server.is_own_process(here)
        monkeypatch.setattr(job_server.os, "geteuid", lambda: os.getuid() + 1)
        assert not job_server.is_own_process(here)


def test_files_of_the_working_folder_are_not_imported_and_a_long_tmpdir_stays_empty(server):
    done = server.run("import queue; print(queue.__file__)", cwd=server.folder.parent)
    assert done.returncode == 0 and str(server.folder) not in done.stdout
    assert not list((server.folder.parent / LONG).iterdir())


def test_where_no_socket_can_be_made_jobs_start_by_themselves(monkeypatch, tmp_path):
    def refuse(self, address):
        raise PermissionError

    monkeypatch.setattr(job_server.socket, "socket", type("Refused", (socket.socket,), {"bind": refuse}))
    assert job_server.start("python", tmp_path) == "python"
