"""A Slurm of our own, of one node, on loopback: munged, slurmctld and slurmd, as Debian installs them.

Its configuration is linked at /etc/slurm/slurm.conf while it runs, because job steps look nowhere else.
"""

import os
import shutil
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path

CONFIG = Path("/etc/slurm/slurm.conf")
DAEMONS = ("munged", "slurmctld", "slurmd")
TEMPLATE = """\
ClusterName=gaspart
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmdPort={next_port}
SlurmUser=root
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
SlurmdParameters=config_overrides
ReturnToService=2
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=8000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def why_not():
    """Why there can be no Slurm here; None if there can."""
    missing = [name for name in DAEMONS if shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin") is None]
    if missing:
        return f"Slurm is not installed here (no {', '.join(missing)}): apt-get install slurm-wlm munge"
    if os.geteuid() != 0:
        return "starting Slurm's daemons needs root"
    if CONFIG.exists():
        return f"{CONFIG} is there: this machine has a Slurm of its own"
    return None


def output_of(*command):
    """What a command prints; raises with its complaints."""
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@contextmanager
def cluster(folder):
    """Slurm, ready for jobs; gives the node's name."""
    host, port = os.uname().nodename.split(".")[0], 16800 + os.getpid() % 1000 * 2
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.write_bytes(os.urandom(128))
    key.chmod(0o600)
    config = folder / "slurm.conf"
    config.write_text(TEMPLATE.format(host=host, port=port, next_port=port + 1, folder=folder))
    CONFIG.parent.mkdir(exist_ok=True)
    CONFIG.symlink_to(config)
    places = [f"--{what}-file={folder}/munge.{what}" for what in ("key", "pid", "log", "seed")]
    commands = [
        ["/usr/sbin/munged", "--force", "--foreground", f"--socket={folder}/munge.socket", *places],
        ["/usr/sbin/slurmctld", "-D"],
        ["/usr/sbin/slurmd", "-D", "-N", host],
    ]
    started = []
    try:
        with (folder / "daemons.log").open("w") as log:
            for command in commands:
                started.append(subprocess.Popen(command, stdout=log, stderr=log))
                time.sleep(1.0)
        _wait_until_idle(folder)
        yield host
    finally:
        subprocess.run(["scancel", "--partition=all"], capture_output=True)
        for daemon in reversed(started):
            _stop(daemon)
        CONFIG.unlink()


def _stop(daemon):
    daemon.terminate()
    try:
        daemon.wait(timeout=3)
    except subprocess.TimeoutExpired:
        daemon.kill()
        daemon.wait()


def _wait_until_idle(folder):
    for _ in range(60):
        if "idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True).stdout:
            return
        time.sleep(0.5)
    logs = "\n".join(path.read_text()[-2000:] for path in folder.glob("*.log"))
    raise RuntimeError(f"Slurm does not start:\n{logs}")
