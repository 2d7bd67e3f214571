"""Common frame of all scripts of the workflow: this checkout's library, one log, one line per failure."""

import gc
import os
import sys
import traceback
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path

# Jobs share the cores. Threads for products of matrices would spin while they wait, 0.2 s even in a job that
# has no such products; and their number would change last digits.
os.environ["OPENBLAS_NUM_THREADS"] = "1"
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "src"))

from gaspart.errors import SceneError, SimulationError
from gaspart.interruption import exit_on_signals
from gaspart.reproduction import job_time

exit_on_signals()  # before the slow imports of the scripts
# What is loaded or compiled are some million objects, which stay. They are not searched repeatedly: 0.15 s of
# a job's start, 3 % of the compiler's time.
gc.set_threshold(1_000_000)


@contextmanager
def job(snakemake):
    """Send output to the rule's log. A failure is one line, there and on the terminal.

    A user's mistake leaves no traceback and gives exit code 2; any other failure leaves a traceback in the
    log alone. A signal is one line too, with exit code 130 or 143, after the state has been saved. The log of
    a job that succeeds ends with its processor time.
    """
    name = " ".join(["gaspart:", snakemake.rule, *snakemake.wildcards])
    terminal = os.dup(2)
    with open(snakemake.log[0], "w", buffering=1, encoding="utf-8") as log:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
            os.dup2(log.fileno(), stream.fileno())
            stream.reconfigure(line_buffering=True)  # a log shows progress, and the reason of a failure last

        def report(text):
            """Write without locks, which another thread may hold."""
            line = f"{name}: {text}"
            for number, where in ((terminal, f" ({snakemake.log[0]})"), (log.fileno(), "")):
                with suppress(OSError):  # there may be no room for the log
                    os.write(number, f"{line}{where}\n".encode(errors="surrogateescape"))

        exit_on_signals(report)
        try:
            yield
        except Exception as error:
            expected = isinstance(error, (SceneError, SimulationError, OSError))
            if not expected:
                with suppress(OSError):
                    traceback.print_exc(file=log)
            report(str(error) if expected else f"{type(error).__name__}: {error}")
            sys.exit(2 if expected else 1)
        print(job_time.describe())


def function(module, name):
    """The function ``name`` of a module given by name."""
    return getattr(import_module(module), name)
