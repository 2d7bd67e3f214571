"""What is run again after a change, and what is not."""

import resource

import pytest
from workspace import ROOT, SMOKE

from gaspart.files import dump_yaml, read_yaml

pytestmark = pytest.mark.workflow

SIMULATIONS = {"simulate", "measure_cost", "compare", "echo", "fill", "pack"}
PACKING_FRACTIONS = read_yaml(ROOT / "config/smoke.yaml")["experiments"]["virial_discs"]["grid"][
    "packing_fraction"
]


def test_nothing_to_do_takes_less_than_three_seconds(smoke):
    """Of processor time, which the other tests on this machine hardly change."""
    spent = []
    for _ in range(3):
        start = resource.getrusage(resource.RUSAGE_CHILDREN)
        assert smoke.plan(*SMOKE) == {}
        end = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent.append(end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime)
    assert min(spent) < 3.0


def test_adding_a_point_simulates_that_point_only(smoke, tmp_path):
    more = tmp_path / "more.yaml"
    values = [0.07, *PACKING_FRACTIONS]
    more.write_text(dump_yaml({"experiments": {"virial_discs": {"grid": {"packing_fraction": values}}}}))
    plan = smoke.plan(*SMOKE, str(more))
    assert SIMULATIONS & set(plan) == {"simulate"}
    assert plan["simulate"] == 1
    assert "warm" not in plan
    assert plan["measure"] == plan["draw"] == plan["judge"] == 1


def test_a_longer_run_reruns_its_experiment_only(smoke, tmp_path):
    longer = tmp_path / "longer.yaml"
    longer.write_text("experiments: {virial_discs: {point: {samples: 40}}}")
    plan = smoke.plan(*SMOKE, str(longer))
    assert SIMULATIONS & set(plan) == {"simulate"}
    assert plan["simulate"] == len(PACKING_FRACTIONS)
    assert plan["measure"] == 1


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("src/gaspart/figures/virial.py", {"draw", "report", "all"}),
        ("src/gaspart/claims/virial.py", {"judge", "claims", "report", "all"}),
        ("src/gaspart/theory/virial.py", {"measure", "judge", "draw", "claims", "report", "all"}),
        ("src/gaspart/families.py", {"report", "all"}),
        ("src/gaspart/config.py", set()),
        ("config/README.md", set()),
    ],
)
def test_editing_a_module_reruns_what_uses_it(smoke, path, expected):
    file = smoke.path / path
    before = file.read_text()
    file.write_text(before + "\n# edited\n")
    try:
        assert set(smoke.plan(*SMOKE)) == expected
    finally:
        file.write_text(before)


def test_editing_the_physics_of_a_contact_simulates_everything_again(smoke):
    undo = smoke.edit("src/gaspart/contact.py", '"""', '"""Edited. ')
    try:
        plan = smoke.plan(*SMOKE)
    finally:
        undo()
    assert set(plan) >= {"warm", "simulate", "measure_cost", "measure", "judge", "draw"}
    assert "fill" not in plan


def test_warming_again_reruns_nothing_else(smoke):
    assert set(smoke.plan(*SMOKE, "--forcerun", "warm")) == {"warm"}


def test_one_figure_and_the_named_targets_can_be_asked_for(fresh):
    plan = fresh.plan(*SMOKE, "--", "results/figures/virial_discs.png")
    assert plan["draw"] == plan["measure"] == 1
    assert "judge" not in plan
    assert "draw" not in fresh.plan(*SMOKE, "--", "claims")
    assert "report" in fresh.plan(*SMOKE, "--", "report")


def test_the_full_reproduction_can_be_planned(fresh):
    plan = fresh.plan()
    assert plan["draw"] == plan["measure"] == plan["judge"]
