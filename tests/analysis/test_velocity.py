"""The mean velocity along an axis, and the part of a run until a time."""

import math

import numpy as np
import pytest
import xarray as xr
from scenes import gas

import gaspart as gp
from gaspart.analysis.measuring import measure
from gaspart.cli import main
from gaspart.errors import SceneError

A = gp.analysis
GAS = gas(3, 64, 0.1, exact_temperature=True)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    target = tmp_path_factory.mktemp("run") / "run.nc"
    return str(gp.run(GAS, gp.EventDriven(), 1, 40.0, 0.25, target, displacements=True))


def between_plates(knudsen, seed):
    """Of 500 points between x_low, at rest, and x_high, which slides with 0.5. A flow takes gap / thermal
    speed / Knudsen number, 20 to 40, to arise."""
    gap, side, count = 2.0, 2.0, 500
    diameter = (math.sqrt(2.0) * math.pi * count / side**2 * knudsen) ** -0.5
    faces = {
        f"x_{name}": gp.Thermal(1.0, velocity=(0.0, u, 0.0)) for name, u in (("low", 0.0), ("high", 0.5))
    }
    container = gp.Container((gap, side, side), ("wall", "periodic", "periodic"))
    scene = gp.Scene(container, [gp.Species(count, diameter / 2, temperature=1.0)], faces=faces)
    simulation = gp.Simulation(scene, gp.DSMC(0.02, (40, 1, 1), "boltzmann"), seed=seed)
    simulation.advance(duration=200.0)
    return simulation


@pytest.mark.thorough
@pytest.mark.parametrize("knudsen", [0.05, 1e6])
def test_between_sliding_plates(knudsen):
    """A fluid slips by 1.11 free paths at each plate: its slope is 0.90 of that without slip. In free flight
    nothing changes along the gap. Bins share the slow modes of the flow: the slope is judged, by 6 seeds."""
    runs = [between_plates(knudsen, seed) for seed in range(6)]
    found = A.replicas("velocity", runs, start=50.0, axis="x").sel(component="y")
    places = found["position"].values
    slopes = [np.polyfit(places[4:-4], one[4:-4], 1)[0] for one in found["velocity_replicas"].values]
    mean, error = np.mean(slopes), np.std(slopes, ddof=1) / math.sqrt(6.0)
    if knudsen < 1.0:
        gap = 2.0 - 2.0 * runs[0].scene.largest_radius
        expected = 0.5 / gap / (1.0 + 2.0 * 1.1113 * 0.05)
        assert np.isnan(found.theory.values[[0, -1]]).all()
        middle = found.theory.values[6:-6]
        assert middle == pytest.approx(0.25 + expected * (places[6:-6] - 1.0), rel=1e-4)
    else:
        expected = 0.0
        assert found.theory.values == pytest.approx(0.25)
    assert abs(mean - expected) < 4.9 * error + 0.005  # Student's, as rare as 3 sigma; second order
    assert error < 0.015


CHANNELS = {  # (lengths, number, force, engine, duration), at Knudsen numbers of 0.06 and 0.05
    "event": ((101.0, 10.0, 10.0), 380, 1e-3, gp.EventDriven(), 8000.0),
    "dsmc": ((2.0, 2.0, 2.0), 500, 0.05, gp.DSMC(0.01, (40, 1, 1), "boltzmann"), 200.0),
}


@pytest.mark.thorough
@pytest.mark.filterwarnings("ignore:gaspart. cells_per_side")  # they are long along the flow
@pytest.mark.parametrize("name", CHANNELS)
def test_a_force_drives_poiseuilles_flow_between_plates(name):
    """0.21 of the velocity in the middle is slip: in proportion to theory, by 6 seeds."""
    lengths, count, force, engine, duration = CHANNELS[name]
    radius = 0.5 if name == "event" else 0.5 * (math.sqrt(2.0) * math.pi * count / 4.0 * 0.05) ** -0.5
    container = gp.Container(lengths, ("wall", "periodic", "periodic"))
    gas = [gp.Species(count, radius, temperature=1.0)]
    faces = dict.fromkeys(("x_low", "x_high"), gp.Thermal(1.0))
    scene = gp.Scene(container, gas, faces=faces, gravity=(0.0, force, 0.0))
    runs = [gp.Simulation(scene, engine, seed) for seed in range(6)]
    for run in runs:
        run.advance(duration=duration)
    found = A.replicas("velocity", runs, start=duration / 6.0, axis="x")
    for component in "xz":
        across = found.sel(component=component)
        means = across["velocity_replicas"].values[:, 8:-8].mean(axis=1)
        assert not across.theory.values[8:-8].any()
        assert abs(means.mean()) < 4.9 * means.std(ddof=1) / math.sqrt(6.0)
    along = found.sel(component="y")
    shape = along.theory.values
    known = np.isfinite(shape)
    shares = [
        one[known] @ shape[known] / (shape[known] @ shape[known]) for one in along["velocity_replicas"].values
    ]
    mean, error = np.mean(shares), np.std(shares, ddof=1) / math.sqrt(6.0)
    wrong = float(along["velocity_theory_error"].max()) / shape[known].max()
    assert shape[known].max() == pytest.approx(0.34, abs=0.01) and 20 <= known.sum() < 36
    assert error < 0.035 and wrong < 0.07
    assert abs(mean - 1.0) < 4.9 * error + wrong  # Student's, as rare as 3 sigma


@pytest.mark.thorough
def test_profiles_of_a_species():
    """Two species under gravity, of one temperature: their densities add up to that of all."""
    species = [gp.Species(60, 0.4, temperature=1.0), gp.Species(30, 0.3, mass=4.0, temperature=1.0)]
    container = gp.Container((6.0, 6.0, 8.0), ("periodic", "periodic", "wall"))
    simulation = gp.Simulation(
        gp.Scene(container, species, gravity=(0.0, 0.0, -0.2)), gp.EventDriven(), seed=1
    )
    simulation.advance(duration=60.0)
    parts = [measure(simulation, "density", species=kind) for kind in (0, 1)]
    whole = measure(simulation, "density")
    assert sum(float(one.estimate.sum()) for one in parts) * 36.0 * 0.2 == pytest.approx(90.0)
    np.testing.assert_allclose(parts[0].estimate + parts[1].estimate, whole.estimate)
    assert all(one.theory is None for one in parts)
    heavy, light = (float(one.estimate[:20].sum() / one.estimate.sum()) for one in parts[::-1])
    assert heavy > light + 0.1
    for kind in (0, 1):
        found = A.profile(simulation, "temperature", bins=4, species=kind)
        assert (abs(found.deviation) < 4.5).all() and (found.error < 0.2).all()


def test_the_end_is_that_of_the_frames_that_count(path):
    with xr.open_dataset(path) as data:
        cut = data.isel(frame=slice(81))  # until 20
        for name in ("Z", "msd", "velocity"):
            expected, found = measure(cut, name), measure(path, name, end=20.0)
            assert expected.identical(found)
    with pytest.raises(SceneError, match="end = 0.1: leaves 1 frames"):
        measure(path, "Z", end=0.1)
    simulation = gp.Simulation(GAS, gp.EventDriven(), seed=1)
    simulation.advance(duration=20.0)
    whole, half = measure(simulation, "Z", start=0.0), measure(simulation, "Z", start=0.0, end=10.0)
    assert 2 * half["stretches"].size >= whole["stretches"].size and float(half.error) > float(whole.error)


def test_the_command_line_has_them(path, capsys):
    def printed(*arguments, code=0):
        assert main(["measure", path, *arguments]) == code
        text = capsys.readouterr()
        return (text.err if code else text.out).splitlines()

    head, *rows = printed("velocity", "--axis", "x", "--end", "20")
    assert head.split()[:3] == ["position", "velocity", "x"]
    assert len([row for row in rows if not row.startswith("(")]) == 10
    late, early = printed("Z", "--start", "20"), printed("Z", "--end", "20")
    assert late != early != printed("Z")
    assert printed("field", "--axes", "xz", "--cells", "4,3", "--of", "temperature")[0].startswith(
        "temperature in 4 x 3 cells along x, z: "
    )
    *cells, note = printed("field", "--axes", "x", "--cells", "4")
    assert len(cells) == 5 and note.startswith("(by counts; a run with --impulses")
    components = printed("field", "--of", "velocity", "--cells", "3")
    assert [line.split(" in ")[0] for line in components[:3]] == ["velocity x", "velocity y", "velocity z"]
    for arguments, rule in (
        (("Z", "--axes", "x"), "--axes is defined only for field"),
        (("field", "--of", "speed"), "of = 'speed'"),
        (("field", "--axis", "x"), "axis = 'x'"),
        (("field", "--axes", "xx"), "each once"),
        (("Z", "--end", "0.1"), "end = 0.1"),
    ):
        (line,) = printed(*arguments, code=2)
        assert rule in line
