"""Made-up values beside those of others with known answers, in the form that `measure.literature` gives."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.claims.data import judged
from reproduction.families.drawn import Points, draw, shows, varied

from gaspart import theory
from gaspart.reproduction.families.equation_of_state.claims import literature as claims_of_literature
from gaspart.reproduction.families.equation_of_state.figure import LABELS
from gaspart.reproduction.families.equation_of_state.figure import literature as draw_literature
from gaspart.reproduction.families.equation_of_state.measure import literature as measure_literature
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point

ROWS = [
    ("Z", 3, 0.1, 1000, 2e-4, 0),
    ("Z", 3, 0.157079633, 1372, 2e-4, 1),
    ("Z", 3, 0.261799388, 1372, 2e-4, 1),
    ("Z_crystal", 3, 0.544647059, 1372, 2e-4, 1),
    ("pressure", 2, 0.68, 870, 2e-4, 0),
    ("diffusion", 3, 0.157079633, 1372, 4e-3, 1),
    ("diffusion", 3, 0.366519143, 1372, 4e-3, 1),
    ("viscosity", 3, 0.261799388, 1372, 0.03, 1),
    ("conductivity", 3, 0.261799388, 1372, 0.03, 1),
]
"""quantity, dimension, packing fraction, count, relative error of ours, whether it has a claim of its own."""


def beside_others(factor=1.0, noise=1.0, seed=1):
    """Published values, ours `factor` times as large with `noise` times the scatter that their errors say."""
    rng = np.random.default_rng(seed)
    columns = {name: [] for name in ("value", "error", "source")}
    for quantity, dimension, eta, *_ in ROWS:
        known = theory.literature(quantity, dimension)
        one = known[np.abs(known.packing_fraction - eta) < 1e-8][0]
        for name, values in columns.items():
            values.append(one[name])
    theirs, error = np.array(columns["value"]), np.array(columns["error"])
    quantity, dimension, eta, count, relative, judged = (
        np.array(column) for column in zip(*ROWS, strict=True)
    )
    own = relative * theirs
    ours = factor * theirs + noise * np.hypot(own, error) * rng.standard_normal(len(ROWS))
    found = {
        "quantity": quantity, "dimension": dimension, "packing_fraction": eta, "count": count,
        "ours": ours, "ours_error": own, "theirs": theirs, "theirs_error": error,
        "source": np.array(columns["source"], dtype=str), "judged": judged,
    }  # fmt: skip
    return xr.Dataset({name: ("value", values) for name, values in found.items()})


GAS = {
    "dimension": 3,
    "count": 1372,
    "radius": 0.5,
    "packing_fraction": 0.261799388,
    "boundary": "periodic",
    "temperature": 1.0,
    "exact_temperature": True,
    "arrangement": "lattice",
    "engine": "event",
    "collisions_per_particle": 40,
    "equilibration": 15,
    "samples": 40,
    "replicas": 2,
}
TRANSPORT = {"lags": 10, "stress": True, "follow": 1}
DIFFUSION = {"lags": 16, "displacements": True, "collisions_per_particle": 64, "samples": 32}


def measured(gas, tmp_path, monkeypatch, judged=()):
    """The table of one point, which is simulated."""
    monkeypatch.chdir(tmp_path)
    one = Point("gases", "one", "simulate", GAS | gas, "results", 1)
    (tmp_path / one.path).parent.mkdir(parents=True)
    simulate(tmp_path / one.path, **one.arguments)
    return measure_literature([one], {"judged": list(judged)})


def test_z_is_that_of_infinite_systems(tmp_path, monkeypatch):
    """108 spheres have a Z that is 1 % below that of a million."""
    few = {"count": 108, "packing_fraction": 0.4, "collisions_per_particle": 600}
    found = measured(few, tmp_path, monkeypatch, ["gases"])
    (row,) = (found.isel(value=n) for n in range(found.sizes["value"]))
    assert str(row["quantity"].values) == "Z" and int(row["judged"]) == 1
    assert float(row["theirs"]) == pytest.approx(6.9455088, abs=1e-4)
    assert float(row["ours_error"]) < 0.02 * float(row["theirs"])
    assert abs(float(row["ours"] - row["theirs"])) < 4.5 * float(row["ours_error"])


def test_transport_coefficients_are_beside_each_published_one(tmp_path, monkeypatch):
    found = measured(TRANSPORT, tmp_path, monkeypatch)
    assert found["quantity"].values.tolist() == ["viscosity"] * 2 + ["conductivity"] * 2
    assert found["theirs"].values.tolist() == [0.58, 0.541, 2.3, 2.29]
    assert not found["judged"].any()
    assert np.all(abs(found["ours"] / found["theirs"] - 1.0) < 0.8)


def test_diffusion_is_that_of_as_many(tmp_path, monkeypatch):
    found = measured(DIFFUSION | {"packing_fraction": 0.052359878}, tmp_path, monkeypatch)
    assert found["quantity"].values.tolist() == ["diffusion"] and found["theirs"].values.tolist() == [1.929]
    assert found["ours"].values == pytest.approx(1.929, rel=0.15)


def test_values_of_others_agree_and_those_of_other_figures_have_no_claim_of_their_own():
    found = judged(claims_of_literature(beside_others()))
    assert set(found.values()) == {"agrees"}
    assert len(found) == sum(row[-1] for row in ROWS) + 2
    assert [text for text in found if text.startswith("Z of the fluid of spheres at packing fraction 0.1571")]


def test_a_bias_of_a_tenth_of_a_per_cent_is_found():
    found = judged(claims_of_literature(beside_others(factor=1.001, noise=0.0)))
    wrong = [text for text, verdict in found.items() if verdict == "disagrees"]
    assert sum(text.startswith("Z of the ") for text in wrong) == 3
    assert any(text.startswith("Z and pressures beside") for text in wrong)


def test_a_bias_of_diffusion_is_found():
    dataset = beside_others()
    dataset["ours"] = dataset["ours"].where(dataset["quantity"] != "diffusion", 1.03 * dataset["ours"])
    found = judged(claims_of_literature(dataset))
    wrong = {text for text, verdict in found.items() if verdict == "disagrees"}
    assert len(wrong) == 3 and any(text.startswith("transport coefficients") for text in wrong)


def test_values_that_are_too_uncertain_are_inconclusive():
    dataset = beside_others(noise=0.0)
    dataset["ours_error"] = 20.0 * dataset["ours_error"]
    found = judged(claims_of_literature(dataset))
    single = {verdict for text, verdict in found.items() if " at packing fraction " in text}
    assert single == {"inconclusive"}


STATIC = ("Z", "Z_crystal", "pressure")


def test_ratios_with_both_errors():
    ds = varied(beside_others(), "packing_fraction")
    static, transport = draw(draw_literature, ds).axes
    for axis, wanted in ((static, True), (transport, False)):
        expected = []
        for name in LABELS:
            part = ds.isel(value=np.flatnonzero(ds["quantity"] == name))
            if (name in STATIC) != wanted:
                continue
            eta, theirs = part["packing_fraction"], part["theirs"]
            expected.append(Points(eta, 0.0 * eta, 100.0 * part["theirs_error"] / theirs))
            error = 100.0 * part["ours_error"] / theirs
            expected.append(Points(eta, 100.0 * (part["ours"] / theirs - 1.0), error))
        shows(axis, *expected)
