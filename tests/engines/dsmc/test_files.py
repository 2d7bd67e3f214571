"""The DSMC engine from the command line, in files and in configs."""

import json

import pytest

import gaspart as gp
from gaspart.cli import main
from gaspart.reproduction.points.point import compile_kernels, compile_task, variant
from gaspart.reproduction.points.points import points

pytestmark = pytest.mark.thorough

DILUTE = gp.Scene(gp.Container((20.0,) * 3, "periodic"), [gp.Species(2000, 0.1, temperature=1.0)])


def test_a_run_states_its_cells_its_step_and_the_error_that_they_bring(tmp_path, capsys):
    DILUTE.to_file(tmp_path / "scene.yaml")
    path = tmp_path / "run.nc"
    command = ["run", str(tmp_path / "scene.yaml"), "-o", str(path), "--engine", "dsmc", "--duration", "20"]
    assert main([*command, "--sample-interval", "0.5", "--quiet"]) == 0
    with gp.open_trajectory(path) as trajectory:
        engine = json.loads(trajectory.attrs["engine"])
        error = trajectory.attrs["predicted_viscosity_error"]
        assert int(trajectory["collisions"][-1]) > 100 and int(trajectory["steps"][-1]) > 8
    assert (0.5 / engine["time_step"]).is_integer() and len(engine["cells_per_side"]) == 3
    capsys.readouterr()
    assert main(["info", str(path)]) == 0
    text = capsys.readouterr().out
    assert f"predicted viscosity error: {100.0 * error:+.2g} %" in text
    (again,) = (line for line in text.splitlines() if "gaspart run" in line)
    options = again.split("gaspart run ")[1].split()
    options[options.index("-o") + 1] = str(tmp_path / "again.nc")
    assert main(["run", str(tmp_path / "scene.yaml"), *options[1:], "--quiet"]) == 0
    assert (tmp_path / "again.nc").read_bytes() == path.read_bytes()
    assert main(["measure", str(path), "collision_rate", "temperature"]) == 0
    capsys.readouterr()
    assert main(["check", str(path)]) == 0  # particles overlap, as they may
    assert "contacts are sampled" in capsys.readouterr().out


def test_a_config_has_it(tmp_path):
    point = {"dimension": 3, "boundary": "periodic", "radius": 0.1, "count": 500, "temperature": 1.0}
    point |= {"engine": "dsmc", "collisions_per_particle": 2.0, "samples": 3}
    block = {"point": point, "grid": {"packing_fraction": [1e-3], "model": ["boltzmann", "enskog"]}}
    config = {"seed": 1, "points": "results/points", "experiments": {"gas": block}, "figures": {}}
    made = points(config, "gas")
    for one, model in zip(made, ("boltzmann", "enskog"), strict=True):
        assert one.parameters["engine"] == {"name": "dsmc", "model": model, "threads": 1}
        assert variant(one) == f"dsmc-{model}-3d"
        compile_kernels(compile_task(one))
    block["point"]["search"] = "boxes"
    with pytest.raises(gp.SceneError, match="no meaning with engine: dsmc"):
        _ = points(config, "gas")[0].parameters
