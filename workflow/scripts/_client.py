"""Stand for a job that a server runs (gaspart.reproduction.job_server), or run it here if there is none.

python -I -S _client.py SOCKET SCRIPT [ARGUMENT...]
"""

import os
import signal
import sys


def main(path, *arguments):
    """Return the exit code of the job."""
    import socket

    with socket.socket(socket.AF_UNIX) as connection:
        try:
            connection.connect(path)
            answers = connection.makefile("rb")
            request = f"{_quoted(arguments)}\n".encode()
            socket.send_fds(connection, [request[: 1 << 15]], [0, 1, 2])
            connection.sendall(request[1 << 15 :])
            started = answers.readline()
        except OSError:
            started = b""
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


def _quoted(arguments):
    import json

    return json.dumps({"arguments": arguments, "folder": os.getcwd(), "environment": dict(os.environ)})


sys.exit(main(*sys.argv[1:]))
