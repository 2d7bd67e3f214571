"""Stand for a job that a server runs (gaspart.reproduction.job_server), or run it here if there is none.

python -I -S _client.py NAME SCRIPT [ARGUMENT...]
"""

import os
import signal
import sys


def main(name, *arguments):
    """Return the exit code of the job."""
    import socket

    with socket.socket(socket.AF_UNIX) as connection:
        try:
            connection.connect(f"\0{name}")
            require_own_server(connection)
            answers = connection.makefile("rb")
            request = describe_process(arguments)
            socket.send_fds(connection, [request[: 1 << 15]], [0, 1, 2])
            connection.sendall(request[1 << 15 :])
            started = answers.readline() == b"started\n"
        except OSError:
            started = False
        if not started:
            os.execv(sys.executable, [sys.executable, *arguments])
        for number in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, lambda number, frame: connection.sendall(bytes([number])))
        code = int(answers.readline() or 1)
    if code < 0:
        if -code != signal.SIGKILL:
            signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    return code


def require_own_server(connection):
    """Raise OSError if the server belongs to another user."""
    import socket
    import struct

    data = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, struct.calcsize("3i"))
    if struct.unpack("3i", data)[1] != os.geteuid():
        raise PermissionError


def describe_process(arguments):
    """The arguments, and the state of this process that a job has from its parent."""
    import json
    import resource

    umask = os.umask(0o077)
    os.umask(umask)
    state = {
        "arguments": arguments,
        "folder": os.getcwd(),
        "environment": dict(os.environ),
        "umask": umask,
        "niceness": os.getpriority(os.PRIO_PROCESS, 0),
        "processors": sorted(os.sched_getaffinity(0)),
        "limits": {name: resource.getrlimit(getattr(resource, name)) for name in limits(resource)},
        "ignored": [n for n in signal.valid_signals() if signal.getsignal(n) is signal.SIG_IGN],
    }
    return f"{json.dumps(state)}\n".encode()


def limits(resource):
    """The names of all limits of a process."""
    return [name for name in dir(resource) if name.startswith("RLIMIT_")]


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
