"""What the features of a scene cost with an engine."""

import pytest

import gaspart as gp
from gaspart.accuracy import table
from gaspart.accuracy.table import price_of
from gaspart.cli import main

GAS = gp.Scene(gp.Container((12.0,) * 3, "periodic"), [gp.Species(200, 0.5, temperature=1.0)])


def test_a_plain_gas_pays_for_its_collisions_alone():
    price = price_of(GAS, gp.EventDriven(), "Z")
    assert price.ratios == {} and price.unknown == () and price.single is None


def test_features_cost_what_was_measured():
    kinds = [gp.Species(80, 0.5, temperature=1.0), gp.Species(80, 0.5, mass=2.0, temperature=1.0)]
    scene = gp.Scene(
        gp.Container((12.0,) * 3), kinds, gravity=(0.0, 0.0, -0.1), restitution=gp.Restitution(1.0, 1.0)
    )
    price = price_of(scene, gp.EventDriven(), "pressure")
    known = table.prices("event")
    assert price.ratios == {
        "walls of the container": known["walls"],
        "gravity": known["gravity"],
        "rough particles": known["spin"],
        "unequal masses": known["two_masses"],
    }
    assert all(0.8 < ratio < 1.3 for ratio in price.ratios.values())
    assert "the stress tensor" in price_of(GAS, gp.EventDriven(), "shear_viscosity").ratios


def test_what_was_not_measured_is_named():
    heated = gp.Scene(
        gp.Container((12.0, 12.0)),
        [gp.Species(50, 0.5, temperature=1.0)],
        faces={"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(2.0)},
    )
    assert price_of(heated, gp.EventDriven(), "Z").unknown == ("thermal faces of the container",)
    assert "walls of the container" in price_of(heated, gp.DSMC(), "Z").unknown


def test_single_precision_saves_some_time():
    assert 0.5 < price_of(GAS, gp.TimeStepped(0.01), "Z").single < 1.0


@pytest.mark.parametrize("observable", ["Z", "D"])
def test_the_advice_states_it(observable, tmp_path, capsys):
    GAS.to_file(tmp_path / "gas.yaml")
    assert main(["advise", str(tmp_path / "gas.yaml"), "--observable", observable]) == 0
    assert "extra cost        none beside its collisions\n" in capsys.readouterr().out
