"""A gas in which nothing can move is reported."""

import subprocess
import sys
import warnings

import pytest

import gaspart as gp

CONTAINER = gp.Container(lengths=(20.0, 20.0))


def simulated(**scene):
    species = scene.pop("species", [gp.Species(count=10, radius=0.5)])
    return gp.Simulation(gp.Scene(container=CONTAINER, species=species, **scene), seed=1)


@pytest.mark.interpreted
def test_a_gas_at_rest_warns():
    simulation = simulated()
    with pytest.warns(UserWarning, match="give a species a temperature or a speed"):
        simulation.advance(0.5)
    assert simulation.tally.collisions == simulation.tally.wall_hits.sum() == 0


@pytest.mark.interpreted
@pytest.mark.parametrize(
    "scene",
    [
        {"species": [gp.Species(count=10, radius=0.5, speed=1.0)]},
        {"gravity": (0.0, -1.0)},
        {"thermostat": gp.Thermostat(power=1.0, interval=0.1)},
        {"faces": {"x_low": gp.Piston(speed=0.1)}},
        {"species": [gp.Species(count=10, radius=0.5, fixed=True)]},
    ],
    ids=["speed", "gravity", "thermostat", "piston", "fixed"],
)
def test_a_gas_that_something_moves_does_not(scene):
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        simulated(**scene)._warn_at_rest()  # without the kernels of each scene


def test_the_command_line_warns_in_one_line(tmp_path):
    scene = tmp_path / "rest.yaml"
    scene.write_text("container: {lengths: [20.0, 20.0]}\nspecies: [{count: 10, radius: 0.5}]\n")
    words = ["run", str(scene), "-o", str(tmp_path / "rest.nc"), "--duration", "1", "--sample-interval", "1"]
    command = [sys.executable, "-m", "gaspart", *words]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0
    assert done.stderr.count("warning: all particles are at rest") == 1
    assert "simulation.advance" not in done.stderr
