import numpy as np

from gaspart import theory
from gaspart.reproduction.families.transport import measure as transport
from gaspart.reproduction.jobs.simulate import simulate
from gaspart.reproduction.points.point import Point

GAS = {
    "dimension": 3,
    "count": 64,
    "radius": 0.5,
    "packing_fraction": 0.1,
    "boundary": "periodic",
    "temperature": 1.0,
    "exact_temperature": True,
    "arrangement": "lattice",
    "engine": "event",
    "collisions_per_particle": 800,
    "equilibration": 20,
    "samples": 800,
    "lags": 15,
    "stress": True,
    "follow": 1,
    "replicas": 6,
}


def test_coefficients_are_near_enskogs(tmp_path, monkeypatch):
    """At packing fraction 0.1, where these differ from it by a few per cent, by 4 sigma of some 6 %."""
    monkeypatch.chdir(tmp_path)
    one = Point("spheres", "one", "simulate", GAS, "results", 1)
    (tmp_path / one.path).parent.mkdir(parents=True)
    simulate(tmp_path / one.path, **one.arguments)
    for name, function in (("viscosity", transport.viscosity), ("conductivity", transport.conductivity)):
        row = function([one], {}).isel(point=0)
        error = float(row["value_error"])
        assert error < 0.12
        assert abs(float(row["value"]) - 1.0) < 4.5 * error + 0.03
        assert float(row["finite"]) == theory.transport_finite_size_factor(64, 3, name)
        assert abs(float(row["difference"])) < 4.5 * float(row["difference_error"]) + 0.02
        assert abs(float(row["time"][1]) - 1.5) < 0.02
    bulk = transport.viscosity([one], {}).isel(point=0)
    assert float(bulk["bulk_error"]) < 0.15
    assert abs(float(bulk["bulk"]) - 1.0) < 4.5 * float(bulk["bulk_error"]) + 0.03


def test_growth_is_the_integrals_own(tmp_path, monkeypatch):
    """Dilute discs in two small containers: growths are noise, the curves those of `coefficient`."""
    monkeypatch.chdir(tmp_path)
    points = []
    for count in (36, 64):
        gas = GAS | {"dimension": 2, "count": count, "replicas": 4, "samples": 200}
        one = Point(
            "discs", f"count={count}", "simulate", gas | {"collisions_per_particle": 200}, "results", 1
        )
        (tmp_path / one.path).parent.mkdir(parents=True, exist_ok=True)
        simulate(tmp_path / one.path, **one.arguments)
        points.append(one)
    found = transport.logarithmic_growth(points, {"viscosity_from": 4.0, "conductivity_from": 8.0})
    for name, function in (("viscosity", transport.viscosity), ("conductivity", transport.conductivity)):
        plain = function(points, {})
        np.testing.assert_allclose(found[name], plain["running"])
        np.testing.assert_allclose(found["time"], plain["time"])
        late = found["time"].values >= {"viscosity": 4.0, "conductivity": 8.0}[name]
        modes = found[f"{name}_modes"].values
        assert (np.isfinite(modes) == late).all()
        for row in range(2):
            ends = np.flatnonzero(late[row])[[0, -1]]
            grown = np.diff(found[name].values[row, ends]) / np.diff(modes[row, ends])
            assert np.isclose(float(found[f"{name}_growth"][row]), grown[0])
            assert 0.0 < float(found[f"{name}_short_waves"][row]) < 1.0
