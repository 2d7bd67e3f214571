"""Which rules run again after a change."""

import re
import resource
import subprocess
import sys
from collections import Counter

import pytest
from workspace import ROOT, SMOKE, copy_of_project

from gaspart.reproduction.config import merged_with_default
from gaspart.reproduction.points.points import points
from gaspart.yaml_text import dump_yaml

pytestmark = pytest.mark.workflow

SIMULATIONS = {"simulate", "compute"}
FULL, _ = merged_with_default(ROOT / "config/config.yaml")
SMALL, _ = merged_with_default(ROOT / "config/smoke.yaml")
PACKING_FRACTIONS = SMALL["experiments"]["virial_discs"]["grid"]["packing_fraction"]


def processor_time(work):
    """Processor time in seconds of the processes that `work` starts; other tests hardly affect it."""
    start = resource.getrusage(resource.RUSAGE_CHILDREN)
    work()
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    return end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime


def test_after_a_run_nothing_is_to_be_done(smoke):
    assert smoke.plan(*SMOKE) == smoke.plan(*SMOKE, "--cores", "1") == {}  # no parameter depends on threads


@pytest.mark.thorough
def test_the_time_to_plan_is_proportional_to_the_number_of_points(fresh, tmp_path):
    """Two settings vary, one with a hundred values."""

    def plan(number):
        fractions = [round(0.01 + 0.006 * n, 3) for n in range(100)]
        varied = {"packing_fraction": fractions, "samples": list(range(2, 2 + number // 100))}
        big = tmp_path / f"{number}.yaml"
        big.write_text(dump_yaml({"experiments": {"virial_discs": {"grid": varied}}}))
        made = fresh.plan(*SMOKE, str(big), "--", "results/smoke/figures/virial_discs.png")
        assert made["simulate"] == number

    assert processor_time(lambda: plan(4_000)) < 5.0 * processor_time(lambda: plan(1_000))


@pytest.mark.thorough
def test_the_points_are_shared_among_few_cluster_jobs(few, monkeypatch):
    monkeypatch.setenv("GASPART_SHARE", "2/3")
    plan = few.plan(*SMOKE, "--", "points")
    number = sum(len(points(few.config, name)) for name in few.config["experiments"])
    assert sum(plan[job] for job in SIMULATIONS & set(plan)) == len(range(1, number, 3))


START = """
import sys
before = set(sys.modules)
sys.path.insert(0, {scripts!r})
import _job
from gaspart.kernels.compile.cache import load_numba
load_numba(ours=True)
import gaspart as gp
discs = gp.Species(16, 0.5, temperature=1.0, arrangement="lattice")
gas = gp.Scene(gp.Container((9.0, 9.0), "periodic"), [discs])
gp.run(gas, gp.EventDriven(), 1, 0.1, 0.1, {path!r})
print(*{{"scipy.linalg", "coverage", "xarray", "pandas", "matplotlib"}} & set(sys.modules) - before)
"""


def test_a_job_loads_no_module_without_need(tmp_path):
    code = START.format(scripts=str(ROOT / "workflow/scripts"), path=str(tmp_path / "run.nc"))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == []


def made_of_them(config):
    """Return the number of figures made of this experiment, with the scatter of all claims."""
    return 1 + sum("virial_discs" in block["experiments"] for block in config["figures"].values())


def test_adding_a_point_simulates_that_point_only(smoke, tmp_path):
    more = tmp_path / "more.yaml"
    values = [0.07, *PACKING_FRACTIONS]
    more.write_text(dump_yaml({"experiments": {"virial_discs": {"grid": {"packing_fraction": values}}}}))
    plan = smoke.plan(*SMOKE, str(more))
    assert SIMULATIONS & set(plan) == {"simulate"}
    assert plan["simulate"] == 1
    assert "warm" not in plan
    assert plan["figure"] == made_of_them(smoke.config)


@pytest.mark.parametrize(
    ("paths", "expected"),
    [
        (["src/gaspart/reproduction/figures/virial.py"], {"figure", "claims", "report", "all"}),
        pytest.param(
            ["src/gaspart/theory/virial.py"],
            {"figure", "claims", "play", "report", "all"},
            marks=pytest.mark.thorough,
        ),
        pytest.param(["src/gaspart/reproduction/registry.py"], {"report", "all"}, marks=pytest.mark.thorough),
        (["src/gaspart/reproduction/config.py", "config/README.md"], set()),
    ],
)
def test_editing_modules_reruns_what_uses_them(smoke, paths, expected):
    files = [smoke.path / path for path in paths]
    before = [file.read_text() for file in files]
    for file, text in zip(files, before, strict=True):
        file.write_text(text + ("\n_EDITED = 1\n" if file.suffix == ".py" else "\nedited\n"))
    try:
        assert set(smoke.plan(*SMOKE)) == expected
    finally:
        for file, text in zip(files, before, strict=True):
            file.write_text(text)


def test_editing_a_docstring_or_a_comment_reruns_nothing(smoke):
    undo = smoke.edit("src/gaspart/kernels/physics/contact.py", '"""', '# edited\n"""Edited. ')
    try:
        assert not set(smoke.plan(*SMOKE))
    finally:
        undo()


def test_editing_the_physics_of_a_contact_simulates_everything_again(smoke):
    line = "from math import frexp, inf, ldexp, sqrt\n"
    undo = smoke.edit("src/gaspart/kernels/physics/contact.py", line, f"{line}\n_EDITED = 1\n")
    try:
        plan = smoke.plan(*SMOKE)
    finally:
        undo()
    assert set(plan) >= {"warm", "simulate", "compute", "figure"}
    config = smoke.config
    shown = {name for block in config["figures"].values() for name in block["experiments"]}
    jobs = Counter(point.job for name in shown for point in points(config, name))
    assert jobs["fill"] > 0  # without contacts
    assert plan["compute"] == jobs.total() - jobs["simulate"] - jobs["fill"]


@pytest.mark.thorough
def test_warming_again_reruns_nothing_else(smoke):
    assert set(smoke.plan(*SMOKE, "--forcerun", "warm")) == {"warm"}


def test_one_figure_and_the_named_targets_can_be_requested(few):
    plan_of_all = few.plan(*SMOKE)
    assert "figure_for_journal" not in plan_of_all
    plan = few.plan(*SMOKE, "--", "results/smoke/figures/virial_discs.png")
    assert plan["figure"] == 1 and "claims" not in plan
    assert few.plan(*SMOKE, "--", "journal")["figure_for_journal"] == plan_of_all["figure"]


def test_the_full_reproduction_can_be_planned(fresh):
    assert fresh.plan()["figure"] == len(FULL["figures"])


GAS = """
title: a gas
seed: 1
points: results/points
experiments:
  gas:
    point: {dimension: 2, count: 16, radius: 0.5, packing_fraction: 0.1, boundary: periodic, temperature: 1.0,
      arrangement: lattice, duration: 200, samples: 40}
figures:
  gas:
    kind: observable
    observable: Z
    against: packing_fraction
    experiments: [gas]
    claims: [{that: at_least, value: 1.0, required: 1.0, source: repulsion, fails_if: it attracts}]
"""


@pytest.mark.thorough
def test_a_figure_that_is_judged_or_drawn_otherwise_is_not_measured_again(tmp_path):
    copy = copy_of_project(tmp_path)
    names = ("measurements/gas.nc", "claims/gas.csv", "figures/gas.png")

    def make(text):
        """What is in the results, and the log says about the measurement."""
        (tmp_path / "config/config.yaml").write_text(text)
        done = copy.snakemake("--cores", "1", "--", "results/figures/gas.png")
        assert done.returncode == 0, done.stdout
        log = (tmp_path / "results/logs/figure/gas.log").read_text()
        assert copy.plan("--", "results/figures/gas.png") == {}
        return [(tmp_path / "results" / name).read_bytes() for name in names], "not measured again" in log

    (numbers, claims, picture), kept = make(GAS)
    assert not kept
    found, kept = make(GAS.replace("required: 1.0", "required: 2.0"))
    assert kept and found[0] == numbers and found[1] != claims and found[2] == picture
    copy.edit("src/gaspart/rendering/style.py", '"lines.markersize": 3.5', '"lines.markersize": 9.0')
    found, kept = make(GAS)
    assert kept and found[0] == numbers and found[1] == claims and found[2] != picture
    found, kept = make(GAS.replace("samples: 40", "samples: 50"))
    assert not kept and found[0] != numbers


def test_the_first_figures_are_of_the_full_reproduction():
    """They are planned from its points, so that `make` after `make first` repeats nothing."""
    text = (ROOT / "workflow/rules/common.smk").read_text(encoding="utf-8")
    first = re.search(r"FIRST = \[name for name in \(([^)]*)\)", text)
    assert first
    named = re.findall(r'"(\w+)"', first[1])
    assert len(named) == 3 and set(named) <= set(FULL["figures"])
