"""How the benchmarks are run: in full, or with `--small` to try their code."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


def pytest_addoption(parser):
    parser.addoption("--small", action="store_true", help="a few particles each, one round: to try the code")


@pytest.fixture
def small(request):
    return request.config.getoption("--small")


def pytest_benchmark_update_machine_info(config, machine_info):
    from reference import copy_bandwidth, read_latency

    words = {"words": 1 << 16} if config.getoption("--small") else {}
    machine_info["copy_bandwidth_GB_s"] = copy_bandwidth(**words)
    machine_info["read_latency_ns"] = read_latency(**words)
