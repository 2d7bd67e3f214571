import pytest
import xarray as xr
from reproduction.claims.data import judged

from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.brownian import claims as brownian


def measured(**changes):
    """What `measure.brownian` gives of a heavy particle, if theory is right."""
    values = {
        "equal_speeds": False,
        "is_light": False,
        "stepped": False,
        "mass": 100.0,
        "gas_mass": 1.0,
        "replicas": 200,
        "share": 0.02,
        "radius": 10.0,
        "contact": 10.5,
        "mean_free_path": 700.0,
        "friction": 0.05,
        "diffusion": 0.2,
        "expected_equipartition": 1.0,
        "expected_equipartition_error": 0.0,
        "expected_friction": 0.05,
        "expected_friction_error": 0.0,
        "expected_diffusion": 0.2,
        "expected_diffusion_error": 0.0,
        "equipartition": 1.01,
        "equipartition_error": 0.01,
        "measured_friction": 0.0505,
        "measured_friction_error": 0.0007,
        "measured_diffusion": 0.199,
        "measured_diffusion_error": 0.006,
        "end_freedom": 600,
        "end_chi_square": 620.0,
    }
    return xr.Dataset({name: ("point", [value]) for name, value in (values | changes).items()})


def equal_speeds(**changes):
    """The same of a light particle in a gas of equal speeds, for which the linear Boltzmann equation is
    solved."""
    expected = {"expected_equipartition": 0.93, "expected_friction": 0.0475, "expected_diffusion": 0.186}
    errors = {f"{name}_error": 0.001 * value for name, value in expected.items()}
    found = {"equipartition": 0.925, "measured_friction": 0.0478, "measured_diffusion": 0.184}
    others = {"equal_speeds": True, "is_light": True, "mass": 1.0, "share": 0.0}
    return measured(**others | expected | errors | found | changes)


def verdicts(ds):
    return judged([*brownian.brownian_paths(ds), *brownian.brownian_msd(ds)])


def test_theory_agrees_with_itself():
    found = verdicts(measured())
    assert len(found) == 5 and set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("equipartition", 1.06, "equipartition"),
        ("measured_friction", 0.055, "friction"),
        ("measured_diffusion", 0.23, "diffusion"),
        ("end_chi_square", 800.0, "ends of"),
        ("mean_free_path", 90.0, "mean free path"),
    ],
)
def test_each_claim_can_fail(name, value, text):
    found = verdicts(measured(**{name: value}))
    assert {verdict for claim, verdict in found.items() if text in claim} == {"disagrees"}


def test_the_sources_gas_is_not_in_equilibrium():
    """Theory of its own gas is expected, and that of one in equilibrium is excluded, or else undecided."""
    claims = brownian.brownian_msd(equal_speeds())
    assert all("equal speeds" in claim.claim and "Boltzmann" in claim.source for claim in claims[:3])
    assert judge(claims) == ["agrees"] * 4
    assert [claim.alternative for claim in claims[:3]] == [1.0, 0.05, 0.2]
    assert [claim.is_scattered for claim in claims[:3]] == [True, True, False]  # D follows from both
    maxwell = {"equipartition": 1.0, "measured_friction": 0.0505, "measured_diffusion": 0.206}
    assert judge(brownian.brownian_msd(equal_speeds(**maxwell)))[:3] == ["disagrees"] * 3
    assert judge(brownian.brownian_msd(equal_speeds(measured_friction_error=0.0014)))[1] == "inconclusive"


def test_both_engines_are_compared_where_both_have_run_a_scene():
    events = equal_speeds()
    heavy = measured(stepped=False)
    steps = events.assign(stepped=("point", [True]))
    claims = brownian.brownian_msd(xr.concat([heavy, events, steps], "point"))
    both = [claim for claim in claims if "by time steps" in claim.claim]
    assert len(both) == 3 and judge(both) == ["agrees"] * 3
    assert all(claim.measured.value == 1.0 and "equal speeds" in claim.claim for claim in both)
    for name in ("equipartition", "measured_friction", "measured_diffusion"):
        wrong = steps.assign({name: 1.2 * steps[name]})
        found = judged(brownian.brownian_msd(xr.concat([heavy, events, wrong], "point")))
        assert [one for text, one in found.items() if "by time steps" in text].count("disagrees") == 1


def test_a_friction_that_does_not_exclude_the_bare_radius_is_inconclusive():
    found = verdicts(measured(contact=10.1))
    assert {verdict for claim, verdict in found.items() if "friction" in claim} == {"inconclusive"}
