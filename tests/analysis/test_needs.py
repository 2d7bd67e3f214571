"""What is refused of a scene before it is run is what is refused of a run of it, and nothing else."""

from dataclasses import replace

import pytest

import gaspart as gp
from gaspart.accuracy.conditions import require_steady
from gaspart.analysis.measuring import measure
from gaspart.analysis.observables import OBSERVABLES, TOO_SHORT, require_run

BOX = gp.Container((6.0, 6.0, 6.0), boundary="periodic")
SLIT = gp.Container((4.0, 4.0, 8.0), boundary=("periodic", "periodic", "wall"))
HOT = {"radius": 0.5, "temperature": 1.0}
SCENES = {
    "gas": gp.Scene(BOX, [gp.Species(60, **HOT)]),
    "one": gp.Scene(BOX, [gp.Species(1, **HOT)]),
    "few": gp.Scene(BOX, [gp.Species(5, **HOT)]),
    "mixture": gp.Scene(BOX, [gp.Species(30, **HOT), gp.Species(30, 0.3, temperature=1.0)]),
    "sizes": gp.Scene(BOX, [gp.Species(40, 0.4, temperature=1.0, polydispersity=0.2)]),
    "obstacles": gp.Scene(BOX, [gp.Species(40, **HOT), gp.Species(2, 0.5, fixed=True)]),
    "granular": gp.Scene(BOX, [gp.Species(40, **HOT)], restitution=gp.Restitution(0.9)),
    "slit": gp.Scene(SLIT, [gp.Species(20, **HOT)], gravity=(0.0, 0.0, -1.0)),
}
KEPT = {
    "plain": {},
    "pairs": {"pairs": True},
    "stress": {"pairs": True, "correlations": gp.Correlations(0.25, 4, stress=True)},
    "velocities": {"correlations": gp.Correlations(0.25, 4), "displacements": True},
    "some": {"follow": 17},
    "some pairs": {"follow": 17, "pairs": True},
    "some stress": {"follow": 17, "correlations": gp.Correlations(0.25, 4, stress=True)},
}


PLAIN = "one", "few", "mixture", "sizes"
"""Further scenes of `make test`, without kernels of their own; it has runs of them that keep nothing more."""
STORED = {
    "pairs": ["pairs"],
    "stress": ["pairs", "fluxes"],
    "some pairs": ["pairs"],
    "some stress": ["fluxes"],
}
NOT_KEPT = {
    "stress": ("slit", "obstacles", "sizes"),
    "some": ("one", "few"),
    "some pairs": ("one", "few"),
    "some stress": ("one", "few", "slit", "obstacles", "sizes"),
}
"""Scenes of which the engine tallies no stress, and which have too few particles."""


CASES = [(name, kept) for name in SCENES for kept in KEPT if name not in NOT_KEPT.get(kept, ())]
FEW = [
    (name, kept)
    for name, kept in CASES
    if (name in ("gas", "slit") and kept != "some stress") or (kept == "plain" and name in PLAIN)
]


@pytest.mark.parametrize(
    ("name", "kept"),
    [pytest.param(*case, marks=() if case in FEW else pytest.mark.thorough) for case in CASES],
)
def test_it_is_what_a_run_is_refused(tmp_path, name, kept):
    """A run of 40 frames, of which some observables need more."""
    scene, settings = SCENES[name], KEPT[kept]
    path = gp.run(scene, gp.EventDriven(), 1, 10.0, 0.25, tmp_path / "run.nc", **settings)
    for observable in OBSERVABLES:
        found, before = None, None
        try:
            measure(path, observable, start=0.0)
        except gp.SceneError as error:
            found = error
        try:
            require_run(observable, scene, STORED.get(kept, ()), settings.get("follow"))
        except gp.SceneError as error:
            before = error
        if before is None:
            alone = ("count",) if scene.count == 1 else ()  # found after the number of frames
            assert found is None or found.key in (*TOO_SHORT, "sample_interval", *alone), observable
        else:
            assert found is not None and (found.key, found.rule) == (before.key, before.rule), observable


def test_advice_names_the_coefficient_that_loses_energy():
    law = gp.Restitution(tangential=0.3)
    with pytest.raises(gp.SceneError, match=r"restitution.tangential = 0.3: loses energy"):
        require_steady(replace(SCENES["gas"], restitution=law))
