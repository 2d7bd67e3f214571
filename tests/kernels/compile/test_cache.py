"""Where compiled kernels are kept, and what happens where they cannot be."""

import os
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

import gaspart


def test_a_cache_that_cannot_be_written_is_reported_and_costs_time_only(tmp_path):
    """Compiled anew, and what is computed is the same: a kernel of one line stands for all."""
    (tmp_path / "a file").write_text("")
    code = "from gaspart.kernels.compile.policy import kernel; print(kernel(lambda x: 3.0 * x)(0.1))"
    environment = os.environ | {"GASPART_CACHE": str(tmp_path / "a file" / "cache")}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert (done.returncode, done.stdout) == (0, f"{3.0 * 0.1}\n")
    assert "cannot write the kernel cache" in done.stderr and "set GASPART_CACHE" in done.stderr


@pytest.mark.parametrize("chosen", [True, False], ids=["chosen", "not chosen"])
def test_without_a_home_there_is_a_cache_all_the_same(tmp_path, chosen):
    """An unknown user without HOME: the chosen folder, or a temporary one, with one line that reports it."""
    code = """
        import pwd, sys, warnings
        def unknown(user):
            raise KeyError(user)
        pwd.getpwuid = unknown
        import gaspart.kernels.compile.cache, numba
        print(gaspart.kernels.compile.cache.usable_cache("digest"))
        import gaspart.kernels.compile.policy
    """
    environment = {key: value for key, value in os.environ.items() if key not in _CACHES}
    environment |= {"TMPDIR": str(tmp_path)} | ({"GASPART_CACHE": str(tmp_path / "mine")} if chosen else {})
    command = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    own = "mine" if chosen else f"gaspart-{os.getuid()}"
    assert (done.returncode, done.stdout) == (0, f"{tmp_path / own / 'digest'}\n"), done.stderr
    assert ("there is no home for the kernel cache; using " in done.stderr) == (not chosen)
    assert "Traceback" not in done.stderr


_CACHES = ("HOME", "XDG_CACHE_HOME", "GASPART_CACHE", "TMPDIR")


def test_a_temporary_cache_that_others_may_write_to_is_not_used(tmp_path, monkeypatch):
    from gaspart.kernels.compile.cache import usable_cache

    for name in _CACHES:
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    own = tmp_path / f"gaspart-{os.getuid()}"
    own.mkdir()
    for mode, found in ((0o777, None), (0o700, own / "digest")):
        own.chmod(mode)
        with pytest.warns(UserWarning, match="cannot write the kernel cache"):
            assert usable_cache("digest") == found


def test_copies_of_the_package_share_what_was_compiled(tmp_path):
    """A clone, or an update that leaves the kernels alone, need not wait; other types have other files."""
    code = "from gaspart.kernels.physics.rng import log_of; log_of({}); "
    code += "print(sum(log_of.stats.cache_hits.values()))"
    for name in ("one", "two"):
        shutil.copytree(Path(gaspart.__file__).parent, tmp_path / name / "gaspart")
    hits = []
    for name, argument in (("one", 2.0), ("one", 2), ("two", 2.0), ("two", 2)):
        environment = os.environ | {"GASPART_CACHE": str(tmp_path), "PYTHONPATH": str(tmp_path / name)}
        command = [sys.executable, "-c", code.format(argument)]
        hits.append(int(subprocess.run(command, capture_output=True, env=environment, check=True).stdout))
    assert hits == [0, 0, 1, 1]
    assert len(list(tmp_path.glob("*/physics/rng.log_of-*.nbc"))) == 2
