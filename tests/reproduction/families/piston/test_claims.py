import pytest
from reproduction.families.judged import verdicts
from reproduction.families.piston.data import gases

from gaspart.reproduction.families.piston.claims import isothermal_variance, piston


def test_right_data_agree():
    claims = piston(gases())
    assert verdicts(claims) == {"agrees"}
    assert len(claims) == 4 + 4 + 4 + 1 + 6


@pytest.mark.parametrize(
    ("wrong", "claim"),
    [
        ({"exponent": 1.01}, "adiabatic exponent of discs, compressed"),
        ({"back": 0.99}, "adiabatic exponent of spheres, expanded"),
        ({"factor": 1.004}, "compressibility factor"),
        ({"fluctuation": 1.2}, "variance"),
        ({"energy": 1.5}, "kinetic energy of the piston"),
        ({"heat": 1.0 + 1e-9}, "kinetic energy after"),
        ({"speed": 0.99}, "mean speed"),
        ({"share": 0.48}, "share"),
    ],
)
def test_wrong_data_disagree(wrong, claim):
    assert verdicts(piston(gases(**wrong)), claim) == {"disagrees"}
    assert verdicts(piston(gases()), claim) == {"agrees"}


def test_the_variance_of_an_ideal_gas_at_constant_temperature():
    """That of Poisson's distribution, 1/N of the volume squared; at constant enthalpy 1 / gamma of it."""
    assert isothermal_variance(1e-3, 2) == pytest.approx(1.0 - 4e-3, rel=1e-4)
