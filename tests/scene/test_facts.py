"""Facts of a scene: computed once, and never stale."""

import pickle
from dataclasses import replace

import pytest

import gaspart as gp
from gaspart.scene.faces import Open
from gaspart.scene.surfaces import Thermal
from gaspart.trajectory.reading import open_trajectory

BOX = gp.Container((6.0, 8.0))
DISCS = gp.Species(20, 0.25, temperature=1.0)
POST = gp.Particle((3.0, 4.0), (0.0, 0.0), 0.5, fixed=True)


def test_a_fact_is_computed_once():
    scene = gp.Scene(BOX, [DISCS], faces={"x_low": gp.Thermal(1.0)})
    assert scene.kinds is scene.kinds
    assert scene.faces_of(Thermal) is scene.faces_of(Thermal)
    assert scene.container.periodic is scene.container.periodic


def test_facts_are_no_part_of_a_scene():
    scene, same = (gp.Scene(BOX, [DISCS], faces={"x_low": gp.Thermal(1.0)}) for _ in range(2))
    before = repr(scene), scene.to_dict()
    assert scene.capacity == 20 and scene.flow_axes == () and scene.gas is None
    assert (repr(scene), scene.to_dict()) == before
    assert scene == same and scene == pickle.loads(pickle.dumps(scene)) == gp.Scene.from_dict(scene.to_dict())


def test_a_changed_copy_has_facts_of_its_own():
    scene = gp.Scene(BOX, [DISCS])
    assert scene.count == 20 and not scene.has_fixed and scene.conserved_axes == (False, False)
    more = scene.with_particles(POST)
    assert more.count == 21 and more.moving_count == 20 and more.has_fixed and more.has_obstacles
    assert more.largest_radius == 0.5 and more.largest_moving_radius == 0.25
    round_ = replace(more, container=replace(BOX, boundary="periodic"), particles=())
    assert round_.conserved_axes == (True, True) and round_.is_periodic and round_.walled_axes == ()


@pytest.mark.parametrize(
    ("keys", "axes", "changes"),
    [
        ({}, (), False),
        ({"faces": {"x_low": gp.Piston(speed=0.1)}}, (0,), True),
        ({"faces": {"y_low": gp.Vibrating(0.1, 1.0)}}, (1,), True),
        ({"faces": {"x_low": gp.Open(), "x_high": gp.Open()}, "centres_to_walls": True}, (0,), True),
        ({"faces": {"y_low": gp.Thermal(1.0, velocity=(1.0, 0.0)), "y_high": gp.Thermal(1.0)}}, (1,), False),
    ],
)
def test_the_axes_along_which_a_gas_flows(keys, axes, changes):
    scene = gp.Scene(BOX, [DISCS], **keys)
    assert scene.flow_axes == axes and scene.flow_changes == changes
    assert scene.is_open == bool(scene.faces_of(Open))


def test_a_driven_gas_flows_along_its_walls_and_around_obstacles():
    channel = gp.Container((6.0, 8.0), ("wall", "periodic"))
    faces = {"x_low": gp.Thermal(1.0), "x_high": gp.Thermal(1.0)}
    scene = gp.Scene(channel, [DISCS], gravity=(0.0, 0.1), faces=faces)
    assert scene.driven_axes == (1,) and scene.flow_axes == (0,) and scene.drags_faces
    assert scene.with_particles(POST).flow_axes == (0, 1)


def test_the_frames_of_a_run_ask_no_scene(tmp_path, monkeypatch):
    """The number of calls for faces does not depend on the number of frames."""
    calls = []
    asked = gp.Scene.faces_of
    monkeypatch.setattr(gp.Scene, "faces_of", lambda self, kind: calls.append(kind) or asked(self, kind))
    numbers = []
    for frames in (4, 64):
        calls.clear()
        path = tmp_path / f"{frames}.nc"
        gp.run(gp.Scene(BOX, [DISCS]), gp.EventDriven(), 1, 1.0, 1.0 / frames, path)
        with open_trajectory(path) as data:
            assert data.sizes["frame"] == frames + 1
        numbers.append(len(calls))
    assert numbers[0] == numbers[1]
