"""Made-up measurements of the DSMC engine, as theory states them."""

from __future__ import annotations

import numpy as np
import pytest
from reproduction.claims.data import about, judged
from reproduction.families.drawn import Points, draw, estimates, shows

from gaspart.reproduction.families.dsmc.claims import dsmc_convergence as claims_of_dsmc_convergence
from gaspart.reproduction.families.dsmc.figure import dsmc_convergence as draw_dsmc_convergence
from gaspart.reproduction.families.dsmc.measure import dsmc_convergence as measure_dsmc_convergence
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point
from gaspart.reproduction.table import from_rows
from gaspart.theory import erpenbeck_wood_ratio
from gaspart.theory.discretisation import cell_factor, step_factor

ERROR = 0.003


def known(names):
    """Entries of these numbers, each with an error and its degrees of freedom."""
    errors = {f"{name}_error": ERROR for name in names} | {f"{name}_freedom": 40.0 for name in names}
    return {**names, **errors}


def measured(seed=1):
    """Every part, each number off by a random error."""
    rng, rows = np.random.default_rng(seed), []

    def noisy(value):
        return float(value) * (1.0 + ERROR * rng.normal())

    for width, step in ((0.25, 0.15), (0.5, 0.15), (2.0, 0.15), (0.25, 0.9), (0.25, 1.8), (0.25, 2.7)):
        both = {
            q: cell_factor(q, width) * step_factor(q, step)
            for q in ("viscosity", "conductivity", "diffusion")
        }
        place = {"engine": "DSMC", "width": width, "step": step}
        fluxes = known({q: noisy(both[q]) for q in ("viscosity", "conductivity")})
        transfer = 0.1132 * width**2 * (1.0 - 0.3 * width)
        moved = {"transfer": transfer, "transfer_error": 0.01 * transfer, "transfer_freedom": 40.0}
        rows.append({"part": "fluxes", **place, **fluxes, **moved})
        rows.append({"part": "paths", **place, **known({"diffusion": noisy(both["diffusion"])})})
    for eta in (0.1, 0.3):
        values = {name: noisy(1.0) for name in ("excess", "rate", "diffusion")}
        rows.append({"part": "dense", "engine": "DSMC", "packing_fraction": eta, **known(values)})
        ratio = float(erpenbeck_wood_ratio(eta))
        row = {"part": "event_paths", "engine": "event-driven", "packing_fraction": eta}
        rows.append({**row, **known({"diffusion": noisy(ratio)})})
    for knudsen, flux, eta in ((2.0, 0.8, 4e-4), (0.3, 0.4, 2e-3), (0.03, 0.06, 0.02)):
        for part, engine in (("plates", "DSMC"), ("event_plates", "event-driven")):
            row = {"part": part, "engine": engine, "knudsen": knudsen, "packing_fraction": eta}
            rows.append({**row, **known({"flux": noisy(flux)})})
    narrow = known({"coefficient": 0.1132, "width_slope": -0.034, "step_slope": -0.03})
    return from_rows("point", rows).assign(narrow)


GAS = {
    "dimension": 3,
    "count": 64,
    "radius": 0.5,
    "packing_fraction": 0.0025,
    "boundary": "periodic",
    "temperature": 1.0,
    "exact_temperature": True,
    "engine": "dsmc",
    "cells_per_side": 1,
    "collisions_per_particle": 600,
    "samples": 1200,
    "lags": 30,
    "follow": 1,
    "replicas": 6,
}


@pytest.mark.filterwarnings("ignore:gaspart")
def test_coefficients_of_a_gas_are_near_their_exact_values(tmp_path, monkeypatch):
    """One cell of half a mean free path: viscosity 1.023 times, diffusion once."""
    monkeypatch.chdir(tmp_path)
    made = {"fluxes": {"stress": True}, "paths": {"displacements": True}}
    points = [Point(name, "one", "simulate", GAS | more, "results", 1) for name, more in made.items()]
    for one in points:
        (tmp_path / one.path).parent.mkdir(parents=True)
        simulate(tmp_path / one.path, **one.arguments)
    ds = measure_dsmc_convergence(points, {"parts": {name: [name] for name in made}, "blocks": 4})
    width = float(ds["width"][0])
    assert width == pytest.approx(0.5, abs=0.01)
    expected = {
        "viscosity": 1.0 + 0.1132 * width**2,
        "conductivity": 1.0 + 0.0453 * width**2,
        "diffusion": 1.0,
    }
    for (name, value), row in zip(expected.items(), (0, 0, 1), strict=True):
        found, error = float(ds[name][row]), float(ds[f"{name}_error"][row])
        assert error < 0.15 * value
        assert abs(found - value) < 4.5 * error


def test_what_theory_states_agrees():
    found = judged(claims_of_dsmc_convergence(measured()))
    assert len(found) == 3 + 4 + 1 + 6 + 2
    assert set(found.values()) == {"agrees"}


@pytest.mark.parametrize(
    ("part", "name", "change", "text"),
    [
        ("fluxes", "viscosity", lambda row, x: x * 1.03, "viscosity over Chapman"),
        ("fluxes", "conductivity", lambda row, x: x - 0.02 * row["step"] ** 2, "in the conductivity"),
        ("fluxes", "viscosity", lambda row, x: x - 0.02 * row["step"] ** 2, "(c step/l)^2 in the viscosity"),
        ("paths", "diffusion", lambda row, x: x + 0.02 * row["width"] ** 2, "cells wider"),
        ("paths", "diffusion", lambda row, x: x - 0.02 * row["step"] ** 2, "in the diffusion"),
        ("dense", "rate", lambda row, x: 0.97 * x, "collision rate over Enskog's in the Enskog model"),
        ("dense", "excess", lambda row, x: 0.97 * x, "Z - 1"),
        ("plates", "flux", lambda row, x: 1.05 * x, "heat flux"),
    ],
)
def test_each_claim_can_fail(part, name, change, text):
    ds = measured()
    values = ds[name].values.copy()
    for n in np.flatnonzero(ds["part"].values == part):
        values[n] = change({key: float(ds[key][n]) for key in ("width", "step")}, values[n])
    assert "disagrees" in about(claims_of_dsmc_convergence(ds.assign({name: (ds[name].dims, values)})), text)


def test_another_transfer_disagrees():
    assert about(claims_of_dsmc_convergence(measured().assign(coefficient=0.14)), "(width/l)^2") == {
        "disagrees"
    }


def test_noise_is_inconclusive():
    ds = measured()
    noisy = judged(claims_of_dsmc_convergence(ds.assign(viscosity_error=20.0 * ds["viscosity_error"])))
    about = [claim for claim in noisy if "viscosity" in claim and "width" not in claim]
    assert {noisy[claim] for claim in about} == {"inconclusive"}


def of(ds, part):
    return ds.isel(point=np.flatnonzero(ds["part"].values == part))


def test_plates_and_dense_gases_and_coefficients_without_the_effect_of_the_other_coarseness():
    ds = measured()
    _, steps, plates, dense = draw(draw_dsmc_convergence, ds).axes
    event, own = of(ds, "event_plates"), of(ds, "plates")
    shows(
        plates,
        Points(event["knudsen"], *estimates(event, "flux")),
        Points(own["knudsen"], *estimates(own, "flux")),
    )
    spheres, model = of(ds, "event_paths"), of(ds, "dense")
    eta = model["packing_fraction"].values
    shows(
        dense,
        Points(eta - 0.004, *estimates(model, "excess")),
        Points(eta, *estimates(model, "rate")),
        Points(eta + 0.004, *estimates(model, "diffusion")),
        Points(spheres["packing_fraction"], *estimates(spheres, "diffusion")),
    )
    fine = ds.isel(point=np.flatnonzero(np.isfinite(ds["viscosity"].values) & (ds["width"].values < 0.3)))
    container = next(one for one in steps.containers if one.get_label() == "viscosity")
    x, y = container.lines[0].get_data()
    assert np.allclose(x, fine["step"])
    assert np.allclose(y, fine["viscosity"] / cell_factor("viscosity", fine["width"].values))
