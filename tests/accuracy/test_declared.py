"""What an observable is not defined for is refused with one reason, by whatever asks for it; and its model's
error follows from its declaration."""

import numpy as np
import pytest
import xarray as xr
from scenes import gas

import gaspart as gp
from gaspart.accuracy.advisers import timed_as
from gaspart.accuracy.option import candidates
from gaspart.accuracy.target import Target
from gaspart.analysis.measuring import measure
from gaspart.analysis.observables import OBSERVABLES, require_defined
from gaspart.runs.ending import require_measurable
from gaspart.state.initial import initial_state
from gaspart.theory.conditions import even_conditions
from gaspart.trajectory.run_options import Contents
from gaspart.yaml_text import dump_yaml

CUBE = gp.Container((9.0, 9.0, 9.0), "periodic")
SPECIES = gp.Species(40, 0.5, temperature=1.0)
SCENES = {
    "spheres": gp.Scene(CUBE, [SPECIES]),
    "discs": gas(2, 40, 0.1),
    "walls": gp.Scene(gp.Container((9.0, 9.0, 9.0)), [SPECIES]),
    "slit": gp.Scene(gp.Container((9.0, 9.0, 9.0), ("periodic", "periodic", "wall")), [SPECIES]),
    "sheared": gp.Scene(CUBE, [SPECIES], faces={"y_high": gp.LeesEdwards(shear_rate=0.1)}),
    "resting shear": gp.Scene(CUBE, [SPECIES], faces={"y_high": gp.LeesEdwards(shear_rate=0.0)}),
    "inelastic": gp.Scene(CUBE, [SPECIES], restitution=gp.Restitution(normal=0.9)),
    "two species": gp.Scene(CUBE, [SPECIES, gp.Species(20, 0.4, temperature=1.0, mass=0.5)]),
    "fixed": gp.Scene(CUBE, [SPECIES, gp.Species(2, 0.5, fixed=True)]),
    "one": gp.Scene(CUBE, [gp.Species(1, 0.5, temperature=1.0)]),
    "single": gp.Scene(CUBE, particles=[gp.Particle((1.0, 1.0, 1.0), (1.0, 0.0, 0.0), radius=0.5)]),
}


def frames(scene):
    """Frames of a run in which nothing happens."""
    state, times = initial_state(scene, 0), np.arange(40.0)
    data = {
        "coordinates": (("frame", "atom", "spatial"), np.repeat(state.positions[None], 40, axis=0)),
        "velocities": (("frame", "atom", "spatial"), np.repeat(state.velocities[None], 40, axis=0)),
        "time": ("frame", times),
        "collisions": ("frame", times),
        "kinetic_energy": ("frame", np.full(40, state.kinetic_energy)),
    }
    return xr.Dataset(data, attrs={"scene": dump_yaml(scene.to_dict())})


@pytest.mark.parametrize("kind", SCENES)
def test_all_refuse_alike(kind):
    scene, refused = SCENES[kind], 0
    for name, one in OBSERVABLES.items():
        try:
            require_defined(name, scene)
        except gp.SceneError as error:
            reason = error.rule
        else:
            if one.ends_runs and one.needs != "fluxes" and not one.drives:
                require_measurable(gp.Accuracy(name, 0.1), scene, gp.EventDriven(), Contents())
            continue
        refused += 1
        with pytest.raises(gp.SceneError) as caught:
            measure(frames(scene), name)
        assert caught.value.rule == reason, name
        with pytest.raises(gp.SceneError) as caught:
            Target.from_name(scene, name)
        assert reason in caught.value.rule, name
        if one.ends_runs:
            with pytest.raises(gp.SceneError) as caught:
                require_measurable(gp.Accuracy(name, 0.1), scene, gp.EventDriven(), Contents())
            assert reason in caught.value.rule, name
    assert refused


def test_a_selection_is_refused_before_a_run_as_by_the_function():
    discs = SCENES["discs"]
    for name, selection in (
        ("density", {"axis": "z"}),
        ("msd", {"species": 1}),
        ("msd", {"particles": [40]}),
        ("Z", {"axis": "x"}),
        ("D", {"particles": [1]}),
    ):
        with pytest.raises(gp.SceneError) as before:
            require_defined(name, discs, **selection)
        with pytest.raises(gp.SceneError) as after:
            measure(frames(discs), name, **selection)
        assert before.value.rule == after.value.rule


def test_mutual_diffusion_has_the_model_error_of_diffusion():
    """4000 spheres of two masses at a packing fraction of 0.078: 6.6 % by the Enskog model, not 0.3 %."""
    side = (4000 * np.pi / 6.0 / 0.078) ** (1.0 / 3.0)
    kinds = [gp.Species(2000, 0.5, temperature=1.0, mass=mass) for mass in (1.0, 2.0)]
    scene = gp.Scene(gp.Container((side,) * 3, "periodic"), kinds)
    models = {}
    for name in ("D", "mutual_diffusion"):
        made, _ = candidates(Target.from_name(scene, name), 0.1, even_conditions(scene, 1.0))
        models[name] = {timed_as(one.engine): (one.model, one.discretisation) for one in made}
    assert models["D"] == models["mutual_diffusion"]
    assert models["D"]["dsmc enskog"][0] == pytest.approx(0.066, abs=0.003)
