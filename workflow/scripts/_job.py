"""What every script of the workflow does around its work: this checkout, one log, one clear line."""

import gc
import os
import sys
import traceback
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "src"))

from gaspart.errors import SceneError, SimulationError

gc.set_threshold(1_000_000)  # half a million objects that stay are not looked through again and again: 0.15 s


@contextmanager
def job(snakemake):
    """Send what is printed to the rule's log. A failure is one line, there and on the terminal.

    A user's mistake leaves no traceback and gives exit code 2; anything else leaves one, in the log alone.
    """
    terminal = os.fdopen(os.dup(2), "w", encoding="utf-8")
    with open(snakemake.log[0], "w", buffering=1, encoding="utf-8") as log:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
            os.dup2(log.fileno(), stream.fileno())
        try:
            yield
        except Exception as error:
            expected = isinstance(error, (SceneError, SimulationError, OSError))
            told = str(error) if expected else f"{type(error).__name__}: {error}"
            line = " ".join(["gaspart:", snakemake.rule, *snakemake.wildcards]) + f": {told}"
            print(f"{line} ({snakemake.log[0]})", file=terminal, flush=True)
            with suppress(OSError):  # the log may be what there is no room for
                if not expected:
                    traceback.print_exc(file=log)
                print(line, file=log)
            sys.exit(2 if expected else 1)


def function(module, name):
    """The function ``name`` of a module that is known by its name only."""
    return getattr(import_module(module), name)
