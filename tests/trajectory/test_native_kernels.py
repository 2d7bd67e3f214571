"""Kernels of a wheel, which kernels of this processor replace where that pays; the same bits."""

import json
import os
import shutil
import subprocess
import sys
from hashlib import sha256
from pathlib import Path

import pytest
from scenes import gas

import gaspart as gp
from gaspart.kernels.compile import cache
from gaspart.trajectory import run
from gaspart.trajectory.native_kernels import COMPILATION, GAIN, loaded_kernels, pays

pytestmark = pytest.mark.thorough

SHORTEST = COMPILATION / (1.0 - 1.0 / GAIN)  # two minutes

PROGRAM = """
import sys
from gaspart.kernels.physics.rng import log_of
from gaspart.trajectory import native_kernels
result = [log_of(2.0).hex(), str(sum(log_of.stats.cache_hits.values()))]
if len(sys.argv) > 1:
    feature, seconds = sys.argv[1:]
    native_kernels._features = lambda: {feature: True}
    result.append(str(native_kernels.replace_shipped_kernels(float(seconds))))
print(*result)
"""


@pytest.mark.parametrize(
    ("seconds", "features", "expected"),
    [
        (1.01 * SHORTEST, {"avx2": True, "avx512f": True}, True),
        (0.99 * SHORTEST, {"avx2": True, "avx512f": True}, False),
        (1e9, {"avx2": True, "avx512f": False}, False),
        (1e9, {"avx2": True}, False),
        (1e9, {}, False),
    ],
)
def test_native_kernels_pay_after_long_runs_on_processors_with_longer_vectors(seconds, features, expected):
    assert pays(seconds, features) == expected


def test_a_run_states_its_length_after_its_file_is_complete(tmp_path, monkeypatch):
    stated = []
    monkeypatch.setattr(
        run, "replace_shipped_kernels", lambda seconds: stated.append((seconds, path.exists()))
    )
    path = tmp_path / "a.nc"
    gp.run(gas(3, 20, 0.1), duration=2.0, sample_interval=1.0, path=path)
    assert len(stated) == 1 and stated[0][0] > 0.0 and stated[0][1]
    kernels = loaded_kernels()
    assert any(module.startswith("gaspart.kernels.event") for module, _, _ in kernels) or not kernels


def test_native_kernels_replace_those_of_a_wheel_with_the_same_bits(tmp_path):
    """The processor's features are injected: also a machine without AVX-512 takes the whole way."""
    package = tmp_path / "installed" / "gaspart"
    shutil.copytree(Path(gp.__file__).parent, package)

    def result(*arguments, folder="own", **more):
        environment = os.environ | {"GASPART_CACHE": str(tmp_path / folder)} | more
        environment["PYTHONPATH"] = str(package.parent)
        command = [sys.executable, "-c", PROGRAM, *arguments]
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
        return done.stdout.split()

    def own_files():
        return list(tmp_path.glob("own/*/*/*.nbc"))

    bits, _ = result(folder="v3", NUMBA_CPU_NAME=cache.PROCESSOR, NUMBA_CPU_FEATURES=cache.FEATURES)
    shipped = package / "kernels" / cache.FOLDER.name
    digests = {}
    for file in tmp_path.glob("v3/*/*/*.nbc"):
        path = file.relative_to(tmp_path / "v3")
        (shipped / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, shipped / path)
        digests[path.as_posix()] = sha256(file.read_bytes()).hexdigest()
    (shipped / cache.LIST).write_text(json.dumps(digests))

    assert result("avx2", "1e9") == [bits, "1", "False"]
    assert result("avx512f", "10") == [bits, "1", "False"] and not own_files()
    assert result("avx512f", "1000") == [bits, "1", "True"] and len(own_files()) == 1
    assert result("avx512f", "1000") == [bits, "1", "False"]  # they are stored
    shutil.rmtree(shipped)
    assert result() == [bits, "1"]  # by the native kernel
    own_files()[0].unlink()
    assert result() == [bits, "0"]
