"""What a config costs."""

import re

import pytest

from gaspart.reproduction import cost

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
