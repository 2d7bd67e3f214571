"""Trajectories that keep only the positions of particles, or only their velocities."""

from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.cli import main
from gaspart.errors import SceneError
from gaspart.trajectory.recipe import read_recipe

ROUGH = gp.Scene(
    gp.Container((8.0, 9.0), "periodic"),
    [gp.Species(20, 0.5, temperature=1.0)],
    restitution=gp.Restitution(0.9, 0.5),
)
NAMES = {"positions": "coordinates", "velocities": "velocities"}


def run(path, keep=None, scene=ROUGH, **more):
    settings = {"duration": 4.0, "sample_interval": 0.5, "displacements": True} | more
    return gp.run(scene, gp.EventDriven(), 3, path=path, keep=keep, **settings)


@pytest.mark.parametrize("keep", NAMES)
def test_a_part_of_the_same_run_is_kept(tmp_path, keep):
    whole, part = run(tmp_path / "whole.nc"), run(tmp_path / "part.nc", keep)
    with gp.open_trajectory(whole) as all_of_it, gp.open_trajectory(part) as some:
        gone = {"coordinates", "velocities", "spins"} - {NAMES[keep]}
        assert set(all_of_it) - set(some) == gone
        for name in some:
            assert np.array_equal(some[name], all_of_it[name]), name
    assert read_recipe(part).keep == keep
    saved = whole.stat().st_size - part.stat().st_size
    assert saved > 9 * 20 * 2 * 3 * 4  # frames, particles, vectors of float32


@pytest.mark.parametrize("keep", NAMES)
def test_a_longer_run_goes_on_to_the_bytes_of_one_in_one_go(tmp_path, keep):
    part = run(tmp_path / "part.nc", keep, duration=2.0, keep_checkpoint=True)
    gp.resume(part, duration=4.0)
    assert part.read_bytes() == run(tmp_path / "whole.nc", keep).read_bytes()
    assert gp.last_state(part).spins.any()  # of the checkpoint, which has all of the state


@pytest.mark.parametrize("keep", NAMES)
def test_what_needs_more_says_so_in_one_line(tmp_path, keep, capsys):
    path = run(tmp_path / "part.nc", keep, sample_interval=0.125)
    for function, more in (
        (gp.last_state, ()),
        (gp.export, (tmp_path / "a.data",)),
        (gp.film, (tmp_path / "a.gif",)),
    ):
        with pytest.raises(SceneError, match=f"^keep = '{keep}': "):
            function(path, *more)
    if keep == "velocities":
        with pytest.raises(SceneError, match="keep = 'velocities': .* and coordinates are needed"):
            gp.analysis.rdf(path)
        assert float(gp.measure(path, "speeds").estimate.sum()) > 0.0
    else:
        with pytest.raises(SceneError, match="keep = 'positions': .* and velocities are needed"):
            gp.measure(path, "speeds")
        assert float(gp.analysis.rdf(path, bins=10, furthest=3.0).estimate.sum()) > 0.0
    for command in (["info"], ["check"], ["measure", "collision_rate"]):
        code = main([command[0], str(path), *command[1:]])
        output = capsys.readouterr()
        assert code == 0 or len(output.err.splitlines()) == 1, output.err


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"keep": "spins"}, r"keep = 'spins': must be one of \('positions', 'velocities'\)"),
        (
            {"keep": "positions", "duration": None, "until": gp.Accuracy("collision_rate", 0.1)},
            "keep = 'positions': has no meaning with until",
        ),
    ],
)
def test_what_has_no_meaning_is_refused(tmp_path, wrong, message):
    with pytest.raises(SceneError, match=message):
        run(tmp_path / "a.nc", scene=replace(ROUGH, restitution=None), **wrong)
