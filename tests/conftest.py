"""How the tests are run: which random scenes hypothesis draws, and how several processes share the work."""

import gc
import os
import signal
import sys
from pathlib import Path

import pytest
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

# The same scenes every time, or new ones with `--hypothesis-profile=search`.
settings.register_profile("fixed", max_examples=50, derandomize=True, deadline=None)
settings.register_profile("search", max_examples=2500, deadline=None)
settings.load_profile("fixed")


TESTS = Path(__file__).parent
# These have an environment of their own: make referees.
collect_ignore = ["referees"]
# The files whose tests look at one run of the smoke workflow.
OF_SMOKE_RUN = ("test_smoke.py", "test_accessibility.py", "test_planning.py", "test_archive.py")
# The folder whose files look at the same data sets.
SHARING = "reproduction/families/scaling/"
# Packages whose tests compile hardly any kernel, but for those of some files. They run while the smoke
# workflow compiles those that the others share with it: two processes that need a kernel at the same time
# both compile it.
WITHOUT_KERNELS = ("theory", "reproduction", "scene")
COMPILING = ("approach", "digests", "measure", "own", "pressure", "relaxation", "rows", "simulate")
COMPILING += ("source", "sweep", "variants")


class ByFile(LoadScopeScheduling):
    """A file's tests go to one process, since they share compiled kernels, all of those that look at the
    smoke workflow to one, since they share a run of it, and those of a folder that share data sets."""

    def _split_scope(self, nodeid):
        path = nodeid.split("::")[0]
        if path.endswith(OF_SMOKE_RUN):
            return "smoke"
        return SHARING if SHARING in path else path


def pytest_addoption(parser):
    parser.addoption("--no-skips", action="store_true", help="fail if any test is skipped")


@pytest.hookimpl(tryfirst=True)  # before the terminal prints its summary
def pytest_sessionfinish(session):
    """With --no-skips the exit code is that of a failed test where any was skipped; -ra names each."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if session.config.getoption("no_skips") and reporter and reporter.stats.get("skipped"):
        session.exitstatus = session.exitstatus or pytest.ExitCode.TESTS_FAILED


def compiles(path):
    """Whether tests of a file in `WITHOUT_KERNELS` compile one all the same."""
    return path.stem.removeprefix("test_") in COMPILING or path.parent.name == "pictures"


@pytest.fixture(autouse=True)
def no_figure_stays_open():
    """Close what a test has drawn: matplotlib warns of more than 20 figures, of the tests before it."""
    yield
    if pyplot := sys.modules.get("matplotlib.pyplot"):
        pyplot.close("all")


def pytest_xdist_make_scheduler(config, log):
    return ByFile(config, log)


def pytest_collection_modifyitems(items):
    """Begin with the smoke workflow, which takes longest; the other tests of the workflow, which use its
    kernels, come last."""

    def place(item):
        package = item.path.relative_to(TESTS).parts[0] if item.path.is_relative_to(TESTS) else ""
        if package == "workflow":
            return 0 if item.path.name in OF_SMOKE_RUN else 3
        return 1 if package in WITHOUT_KERNELS and not compiles(item.path) else 2

    items.sort(key=place)
