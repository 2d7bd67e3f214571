"""What a config costs."""

from __future__ import annotations

import math
import re
import subprocess
import sys

import pytest
from reproduction.claims.data import claim

from gaspart.reproduction import cost, job_time
from gaspart.reproduction.claims.judging import sufficient

GASES = """
title: gases
seed: 1
points: results/points
figures: {gas_render: {experiments: [gas]}}
experiments:
  gas:
    point: &gas {dimension: 3, count: 1000000, radius: 0.5, boundary: periodic, speed: 1.0, duration: 100}
    grid: {packing_fraction: [0.1, 0.2]}
  dense:
    point: {dimension: 2, count: 1000000, radius: 0.5, boundary: periodic, speed: 1.0, duration: 100}
    grid: {packing_fraction: [0.71]}
  timed:
    job: measure_cost
    point: *gas
    grid: {packing_fraction: [0.1]}
"""


def core_hours(path):
    """{experiment: core-hours} and what is not predicted."""
    *lines, rest = cost.predict(str(path))
    found = [re.fullmatch(r"(.+?) +([0-9.]+) core-hours", line).groups() for line in lines]
    return {name: float(value) for name, value in found}, rest


def test_a_config_costs_what_it_is_when_laid_over_the_one_beside_it(tmp_path, monkeypatch):
    monkeypatch.setattr(cost, "_speed", lambda gas, engine, precision: 1.0)
    (tmp_path / "config.yaml").write_text(GASES)
    (tmp_path / "longer.yaml").write_text("experiments: {gas: {point: {duration: 500, replicas: 2}}}")
    base, rest = core_hours(tmp_path / "config.yaml")
    longer, _ = core_hours(tmp_path / "longer.yaml")
    assert longer["gas"] == pytest.approx(10.0 * base["gas"], rel=1e-3)
    assert longer["dense"] == base["dense"] > 0.0
    assert longer["all of them"] == pytest.approx(longer["gas"] + longer["dense"], abs=1e-3)
    assert rest.startswith("not predicted") and rest.endswith(": timed")


def test_the_status_states_what_is_left_and_its_time(tmp_path, monkeypatch):
    monkeypatch.setattr(cost, "_speed", lambda gas, engine, precision: 1.0)
    (tmp_path / "config.yaml").write_text(GASES.replace("experiments: [gas]", "experiments: [gas, timed]"))

    def left():
        lines = cost.lines(tmp_path / "config.yaml", progress=True)
        assert lines[1].split()[1:] == lines[2].split()[1:]  # of all, and of the only figure
        return lines[2].removeprefix("gas_render").split(maxsplit=2)

    points, missing, seconds = left()
    assert (points, missing) == ("3", "3") and float(seconds.split(",")[0]) > 10.0
    assert seconds.endswith(", and 1 points of unknown time")
    (tmp_path / "results/points/gas/packing_fraction=0.1").mkdir(parents=True)
    (tmp_path / "results/points/timed").mkdir()
    (tmp_path / "results/points/timed/packing_fraction=0.1.nc").touch()
    log = tmp_path / "results/logs/simulate/gas/packing_fraction=0.1.log"
    log.parent.mkdir(parents=True)
    log.write_text("processor time: 7.00 s, memory: 5.0 MB\n")
    assert left() == ["3", "1", "7"]


# Where the time of a reproduction went, and which length suffices.


def test_the_length_that_suffices_goes_as_the_square_of_the_uncertainty():
    assert sufficient(claim(1.0, 0.01)) == pytest.approx(4.0 * sufficient(claim(1.0, 0.005)))
    required = claim(1.0, 0.01).required
    assert sufficient(claim(1.0, required)) == pytest.approx(1.0)
    distinguished = claim(1.0, 0.01, alternative=1.02)
    assert sufficient(distinguished) == pytest.approx((0.01 / (0.02 / 2.0)) ** 2, rel=0.2)
    assert math.isnan(sufficient(claim(1.0, 0.0)))
    assert math.isinf(sufficient(claim(1.0, 0.01, alternative=1.0)))


SPIN = """
import subprocess, sys, time
from gaspart.reproduction import job_time
spin = "import time\\nwhile time.process_time() < 0.3: pass"
exec(spin)
subprocess.run([sys.executable, "-c", spin], check=True)
print("0.5 of the work is done")
print(job_time.describe())
"""


def test_a_job_states_its_memory_and_its_processor_time_with_that_of_its_children(tmp_path):
    log = tmp_path / "logs/simulate/virial/eta=0.25.log"
    log.parent.mkdir(parents=True)
    with log.open("w") as file:
        subprocess.run([sys.executable, "-c", SPIN], stdout=file, check=True)
    used = job_time.read_used(tmp_path, "simulate", "virial", "eta=0.25")
    assert (
        used.seconds >= 0.58 and 5.0 < used.memory < 4000.0
    )  # of a copy of this process at first, before it runs another program
    log.write_text("processor time: 1.0 s of something\n")
    assert job_time.read_used(tmp_path, "simulate", "virial", "eta=0.25") is None
    assert job_time.read_used(tmp_path, "simulate", "virial", "eta=0.2") is None
