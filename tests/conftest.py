"""How the tests are run: which random scenes hypothesis draws, and how several processes share the work."""

import gc
import os
import signal
import sys
import warnings
from pathlib import Path

import pytest
from battery.loops import LIST, loops_in_use
from hypothesis import settings
from xdist.scheduler import LoadScopeScheduling

# A shell lets what it runs in the background ignore Ctrl-C, and programs inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)

# numba makes a million objects where it compiles, which stay: looking for cycles among them takes some 3 % of
# the time.
gc.set_threshold(1_000_000)

# The processes of the tests share the cores, and threads that spin while they wait for others use them up:
# numpy's matrix products have none, and those of numba sleep. The libraries read this where they are loaded.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

# The same scenes every time, few of them where kernels are plain Python; or new ones with
# `--hypothesis-profile=search`.
settings.register_profile("fixed", max_examples=50, derandomize=True, deadline=None)
settings.register_profile("few", max_examples=5, derandomize=True, deadline=None)
settings.register_profile("search", max_examples=2500, deadline=None)
settings.load_profile("fixed")

INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT") == "1"
"""True if kernels run as plain Python, in which no kernel is compiled."""
if INTERPRETED:
    from kernels.interpreted import do_without_vectors, read_fields

    read_fields()
    do_without_vectors()

OF_CANONICAL_KERNELS = ("battery", "engines", "exact", "scene", "state")
"""Folders whose unmarked tests may use the loops of `battery.compile_kernels` alone; others are warned."""
LOOPS_BEFORE = set()
"""Digests of the engines' loops that earlier tests of this process have used."""
TESTS = Path(__file__).parent
# These have an environment of their own: make referees.
collect_ignore = ["referees"]
# The files whose tests look at one run of the smoke workflow.
OF_SMOKE_RUN = ("test_smoke.py", "test_accessibility.py", "test_planning.py", "test_archive.py")
# The folders that take longest.
FIRST = ("battery", "exact", "workflow")


class ByFile(LoadScopeScheduling):
    """A file's tests go to one process, since they share compiled kernels, and all of those that look at one
    run of the smoke workflow to one, since they share that run."""

    def _split_scope(self, nodeid):
        path = nodeid.split("::")[0]
        if path.endswith(OF_SMOKE_RUN):
            return "smoke, all figures" if "all figures" in nodeid else "smoke"
        return path


def pytest_addoption(parser):
    parser.addoption("--no-skips", action="store_true", help="fail if any test is skipped")
    parser.addoption("--canonical", action="store_true", help="fail unmarked tests that use other kernels")


def pytest_configure(config):
    if INTERPRETED:  # words of random numbers overflow by design
        config.addinivalue_line("filterwarnings", "ignore::RuntimeWarning:gaspart")


@pytest.hookimpl(tryfirst=True)  # before the terminal prints its summary
def pytest_sessionfinish(session):
    """With --no-skips the exit code is that of a failed test where any was skipped; -ra names each."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if session.config.getoption("no_skips") and reporter and reporter.stats.get("skipped"):
        session.exitstatus = session.exitstatus or pytest.ExitCode.TESTS_FAILED


@pytest.fixture(autouse=True)
def no_figure_stays_open():
    """Close what a test has drawn: matplotlib warns of more than 20 figures, of the tests before it."""
    yield
    if pyplot := sys.modules.get("matplotlib.pyplot"):
        pyplot.close("all")


@pytest.fixture(autouse=True)
def only_canonical_kernels(request):
    """With --canonical, fail an unmarked test whose engines run other loops than `make test` has compiled."""
    yield
    if request.config.getoption("canonical") and not INTERPRETED:
        new = loops_in_use() - LOOPS_BEFORE
        LOOPS_BEFORE.update(new)
        marks = {mark.name for mark in request.node.iter_markers()}
        if not {"thorough", "interpreted"} & marks and new - set(LIST.read_text().split()):
            message = "kernels of its own: take a scene of battery/compile_kernels.py, or mark it thorough"
            if place_of(request.node)[0] in OF_CANONICAL_KERNELS:
                pytest.fail(message)
            warnings.warn(message, stacklevel=1)


def pytest_xdist_make_scheduler(config, log):
    return ByFile(config, log)


def place_of(item):
    """Return the folders and the file of a test, below `tests`."""
    return item.path.relative_to(TESTS).parts if item.path.is_relative_to(TESTS) else ("",)


def pytest_collection_modifyitems(config, items):
    """Begin with the smoke workflow and with the folders that take longest."""

    def place(item):
        parts = place_of(item)
        return parts[-1] not in OF_SMOKE_RUN, parts[0] not in FIRST

    items.sort(key=place)
    config.kernels_of_collection = sorted(kernels_in_use())


def kernels_in_use():
    """The names of gaspart's kernels that are compiled or loaded."""
    for name, module in sys.modules.copy().items():
        if name.startswith("gaspart.kernels."):
            for value in vars(module).values():
                if getattr(value, "overloads", None):
                    yield f"{value.py_func.__module__}.{value.py_func.__name__}"
