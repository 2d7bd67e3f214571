"""The table as it is kept: what must hold of any measurement."""

import csv
import io
import math
from functools import partial

import accuracy_table
import numpy as np
import pytest
import xarray as xr

import gaspart as gp
from gaspart import theory
from gaspart.accuracy import table, tabulated
from gaspart.accuracy.of_engine import Candidate
from gaspart.accuracy.option import fluid_option
from gaspart.accuracy.table import price_of
from gaspart.analysis.observables import observables_with
from gaspart.cli import main
from gaspart.reproduction.cost import speed_factor
from gaspart.scene.facts import Gas
from gaspart.theory.diffusion import ERPENBECK_WOOD_UNCERTAINTY
from gaspart.theory.discretisation import contact_values


def test_every_row_is_a_number_with_an_error_of_a_known_quantity():
    known = {
        "seconds",
        *(f"{kind}_{name}" for kind in ("bias", "noise") for name in observables_with(tabulated=True)),
    }
    known |= {f"price_{name}" for name in ("walls", "gravity", "spin", "two_masses", "recording", "stress")}
    assert {row["quantity"] for row in table.read()} == known
    assert all(np.isfinite((row["value"], row["error"])).all() for row in table.read())
    assert {row["dimension"] for row in table.read()} == {2, 3}


def test_unmeasured_time_steps_have_no_bound():
    assert math.isinf(table.bias(3, 0.45, "float64", 0.08, "Z"))
    assert math.isinf(table.bias(3, 0.1, "float64", 0.123, "Z"))
    assert math.isinf(table.seconds(3, 0.45, "step", "float64", 0.08))


@pytest.mark.parametrize("eta", [1e-4, 0.001, 0.01])
def test_noise_of_the_pressure_of_a_dilute_gas_is_that_of_independent_contacts(eta):
    """Z - 1 is a sum over contacts whose momenta have <p^2> / <p>^2 = 4 / pi: the variance of Z is that of
    Poisson's law, 4 / pi, times (Z - 1)^2 / Z^2."""
    z = 1.0 + 4.0 * eta + 10.0 * eta**2
    expected = 4.0 / math.pi * ((z - 1.0) / z) ** 2
    assert table.noise(3, eta, "Z") == pytest.approx(expected, rel=0.5)


def test_this_machine_is_timed_in_less_than_some_seconds():
    assert 0.05 < speed_factor(3, "event", "float64", 500) < 20.0


# What the features of a scene cost with an engine.


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


# The model's table from measurements whose answers are known.


@pytest.fixture
def folder(tmp_path):
    """What the workflow measured: one gas of spheres, its time steps, and the noise of its observables."""
    both = ("row", "step")
    accuracy = xr.Dataset(
        {
            "dimension": ("row", [3, 3]),
            "packing_fraction": ("row", [0.1, 0.1]),
            "setting": ("row", ["4 passes", "1 pass"]),  # of which the second is none to advise
            "timed_dimension": ("timed", [3, 3]),
            "timed_packing_fraction": ("timed", [0.1, 0.45]),
            "timed_seconds": ("timed", [4e-7, 3e-7]),
            "timed_error": ("timed", [1e-8, 1e-8]),
            "dsmc_model": ("dsmc", ["boltzmann", "enskog", "boltzmann"]),
            "dsmc_dimension": ("dsmc", [3, 3, 2]),
            "dsmc_packing_fraction": ("dsmc", [0.01, 0.01, 0.01]),
            "dsmc_step": (("dsmc", "part"), [[4.0, 1.0, 0.5]] * 3),
            "dsmc_step_seconds": (
                ("dsmc", "part"),
                [[2e-7, 3e-7, 4e-7], [8e-7, 9e-7, 1e-6], [1e-7, 2e-7, 3e-7]],
            ),
            "dsmc_step_seconds_error": (("dsmc", "part"), [[1e-8] * 3] * 3),
            "time_step": (both, [[0.01, 0.02, np.nan]] * 2),
            "seconds": (both, [[8e-6, 4e-6, np.nan]] * 2),
            "seconds_error": (both, [[1e-7, 1e-7, np.nan]] * 2),
            "bias": (("row", "observable", "step"), np.full((2, 2, 3), 0.003)),
            "bias_error": (("row", "observable", "step"), np.full((2, 2, 3), 0.001)),
        },
        coords={"observable": ["Z", "collision_rate"]},
    )
    accuracy["bias"][0, 1, 1] = np.nan  # not measured
    accuracy.to_netcdf(tmp_path / "speed_accuracy.nc")
    names = ("Z", "collision_rate")
    virial = xr.Dataset(
        {name: ("point", [2.0]) for name in names} | {f"{name}_error": ("point", [0.01]) for name in names}
    ).assign(packing_fraction=("point", [0.2]), collisions=("point", [1e6]))
    for name in ("virial_spheres", "virial_discs"):
        virial.to_netcdf(tmp_path / f"{name}.nc")
    xr.Dataset(
        {
            "time": (("point", "lag"), [[0.0, 5.0, 10.0]]),
            "collision_rate": ("point", [2.0]),
            "count": ("point", [100]),
            "replicas": ("point", [4]),
            "diffusion": ("point", [0.5]),
            "diffusion_error": ("point", [0.005]),
        }
    ).to_netcdf(tmp_path / "msd_spheres.nc")
    xr.Dataset(
        {
            "engine": ("point", ["event", "event", "step"]),
            "feature": ("point", ["plain", "two masses", "gravity"]),
            "ratio": ("point", [1.0, 1.02, 1.1]),
            "ratio_error": ("point", [0.01, 0.01, 0.02]),
        }
    ).to_netcdf(tmp_path / "price_of_features.nc")
    return tmp_path


def test_the_table_holds_what_was_measured(folder, capsys):
    accuracy_table.main(str(folder))
    output = capsys.readouterr().out
    assert output.startswith("# What accuracy costs")
    rows = list(csv.DictReader(io.StringIO("".join(output.splitlines(keepends=True)[2:]))))
    assert tuple(rows[0]) == table.COLUMNS
    events = [row for row in rows if row["engine"] == "event" and row["quantity"] == "seconds"]
    times = {row["packing_fraction"]: float(row["value"]) for row in events}
    assert times == {"0.1": 4e-7, "0.45": 3e-7}
    found = {(row["engine"], row["time_step"], row["quantity"], row["dimension"]): row for row in rows}
    assert len(found) + 1 == len(rows) == 2 + 3 + 2 + 6 + 4 + 1 + 2
    assert float(found["step", "0.02", "seconds", "3"]["value"]) == 4e-6
    assert float(found["dsmc enskog", "1", "seconds", "3"]["value"]) == 9e-7
    assert [float(found["dsmc", "1", "seconds", d]["value"]) for d in "32"] == [3e-7, 2e-7]
    assert float(found["dsmc", "4", "seconds", "3"]["value"]) == 2e-7
    assert not [key for key in found if key[0] == "dsmc" and key[1] == "0.5"]
    assert float(found["step", "0.02", "bias_Z", "3"]["error"]) == 0.001
    assert ("step", "0.02", "bias_collision_rate", "3") not in found
    assert float(found["event", "0", "price_two_masses", "3"]["value"]) == 1.02
    # (0.01 / 2)^2 of 1e6 contacts; D: (0.01)^2 of 100 / 2 particles x 4 replicas, each of 2 x 10 x 2
    # collisions
    assert float(found["event", "0", "noise_Z", "2"]["value"]) == pytest.approx(25.0)
    assert float(found["event", "0", "noise_D", "3"]["value"]) == pytest.approx(1e-4 * 50 * 4 * 40, rel=1e-3)


# Costs of a fluid, and errors of the models of DSMC that theory states.


def test_the_costs_of_a_fluid_are_those_of_its_contacts():
    """A contact of 2 us, and 1 / 100 of the variance of one contact."""
    gas, candidate = Gas(3, 0.1, 1000, 1.0, 1.0), Candidate(gp.EventDriven())
    option = fluid_option(gas, candidate, 2e-6, 0.01, 1.0, discarded=0.0)
    assert option.cost(1e-3) == pytest.approx(2e-6 * (0.01 / 1e-3**2 + 0.5 * 1000 * 30.0))
    assert option.cost(1.0) == pytest.approx(2e-6 * 0.5 * 1000 * (30.0 + 20.0))


@pytest.mark.parametrize(("dimension", "order"), [(2, 1.564), (3, 2.5)])
def test_the_boltzmann_equation_lacks_contact_value_and_virial(dimension, order):
    """order: of the contact value, 1 + order x packing fraction."""
    z, contact = (float(f(0.1, dimension)) for f in (theory.compressibility_factor, theory.contact_value))
    error = partial(tabulated.model_error, dimension=dimension, equation="boltzmann")
    assert error(0.1, observable="Z") == pytest.approx(1.0 - 1.0 / z)
    assert error(0.1, observable="collision_rate") == pytest.approx(1.0 - 1.0 / contact)
    assert error(1e-3, observable="collision_rate") == pytest.approx(1e-3 * order, rel=0.005)
    for name in ("Z", "collision_rate"):  # a dilute gas has neither
        assert error(1e-6, observable=name) < 1e-5


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_enskog_model_errs_by_the_contact_value_that_its_engine_has(dimension):
    radius, density = np.array([0.5]), np.array([0.3 / theory.particle_volume(dimension)])
    given = contact_values(density, radius, dimension).item()
    error = abs(given / float(theory.contact_value(0.3, dimension)) - 1.0)
    found = tabulated.model_error(0.3, dimension, "enskog", "collision_rate")
    assert 0.0 < found < 0.004 and found == pytest.approx(error, rel=1e-9)
    assert 0.0 < tabulated.model_error(0.3, dimension, "enskog", "Z") < found


def test_both_models_lack_the_memory_of_collisions_in_d():
    ratio = float(theory.erpenbeck_wood_ratio(0.3))
    exact = 1.0 - 1.0 / ratio + ERPENBECK_WOOD_UNCERTAINTY
    assert tabulated.model_error(0.3, 3, "enskog", "D") == pytest.approx(exact, rel=0.02)
    assert tabulated.model_error(1e-6, 3, "boltzmann", "D") < 1e-5
    assert tabulated.model_error(0.01, 2, "boltzmann", "D") == math.inf  # discs have no D
