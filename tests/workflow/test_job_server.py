"""Jobs as copies of a process that has loaded their modules, beside jobs that start by themselves."""

import os
import signal
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
SLEEP = "import os, time; print(os.getpid(), flush=True); time.sleep(60)"


class Server:
    """A process that has started a server, as Snakemake does, and the command of a job."""

    def __init__(self, folder):
        self.folder = folder
        self.parent = subprocess.Popen(
            [sys.executable, "-c", START], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.command = self.parent.stdout.readline().strip()
        children = Path(f"/proc/{self.parent.pid}/task/{self.parent.pid}/children")
        self.process = int(children.read_text())

    def run(self, code, *arguments, **named):
        """The finished process of a job with this script."""
        script = self.folder / "script.py"
        script.write_text(code)
        command = f"{self.command} {script} {' '.join(arguments)}"
        return subprocess.run(["bash", "-c", command], capture_output=True, text=True, **named)

    def begin(self, code):
        """The client of a job that runs, and the job's process."""
        script = self.folder / "long.py"
        script.write_text(code)
        command = f"exec {self.command} {script}"
        client = subprocess.Popen(command, shell=True, stdout=subprocess.PIPE, text=True)
        return client, int(client.stdout.readline())


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    started = Server(tmp_path_factory.mktemp("server"))
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
    for number, code, said in (
        (signal.SIGTERM, 143, "terminated\n"),
        (signal.SIGINT, 130, "interrupted\n"),
    ):
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
    socket = mortal.command.split()[-1]
    assert os.stat(os.path.dirname(socket)).st_mode & 0o077 == 0
    client, _ = mortal.begin("import os, time; print(os.getpid(), flush=True); time.sleep(2); print('done')")
    mortal.parent.kill()
    assert client.communicate()[0] == "done\n" and client.returncode == 0
    assert is_gone(mortal.process) and not os.path.exists(socket)


def test_where_no_folder_can_be_made_jobs_start_by_themselves(monkeypatch, tmp_path):
    monkeypatch.setattr(job_server.tempfile, "tempdir", str(tmp_path / "missing"))
    assert job_server.start("python", tmp_path) == "python"
