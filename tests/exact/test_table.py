"""Each observable in each kind of scene: its exact value, or refused, or stated why none is known."""

import pytest
from exact import rules, table, values
from exact.choice import is_canonical, sample
from exact.kinds import kinds
from exact.known import RULES
from exact.runs import SEED, engines

from gaspart.analysis.observables import OBSERVABLES
from gaspart.engines import ENGINES
from gaspart.scene.faces import FACE_KINDS
from gaspart.scene.features import FEATURES
from gaspart.scene.scene import Scene

SAMPLE, MORE = 10, 4
"""Number of runs in the usual tests, and of further ones of engines that a change touches."""
REPEATED = 50
"""Seed of the repetition, from that of the run."""
FINER = 5
"""Parts of the interval between frames of a kind."""
ELSEWHERE = {
    "viscoelasticity": "dissipates: in no equilibrium",
    "contact_duration": "dissipates: in no equilibrium",
}
"""Features without a kind of scene, and why none has an exact value."""


def check(name, engine, seed=SEED, *run):
    """Raise AssertionError if a cell of a run is wrong, and is so again with another seed.

    Of all parts of all cells of the table, one or two are wrong by chance.
    """
    if wrong := wrong_cells(name, engine, seed, *run):
        again = {cell.observable for cell in wrong_cells(name, engine, seed + REPEATED, *run)}
        wrong = [cell for cell in wrong if cell.observable in again]
    assert not wrong, "\n".join(f"{cell.observable}: {cell.text} ({cell.deviation:.1f})" for cell in wrong)


def wrong_cells(*run):
    return [cell for cell in table.cells(*run) if cell.state == "wrong"]


RUNS = pytest.mark.parametrize(
    ("name", "engine"), table.names(), ids=[" ".join(one) for one in table.names()]
)


@pytest.mark.parametrize(
    ("name", "engine"), sample([run for run in table.names() if is_canonical(*run)], SAMPLE, MORE)
)
def test_a_sample_of_runs_has_the_exact_values(name, engine):
    check(name, engine)


@pytest.mark.thorough
@RUNS
def test_observables_have_their_exact_values(name, engine):
    check(name, engine)


@pytest.mark.thorough
@RUNS
def test_finer_intervals_between_frames_have_the_exact_values(name, engine):
    check(name, engine, SEED + 1, 1.0, FINER)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", (11, 12))
@pytest.mark.parametrize("name", kinds())
def test_longer_runs_have_the_exact_values(name, seed):
    longer = 2.0 if name == "compressed" else 4.0  # its piston would leave no room
    check(name, "event", seed, longer)


def test_no_cell_is_empty():
    assert set(rules.UNDEFINED) >= set(OBSERVABLES)
    assert set(RULES) <= set(rules.UNDEFINED)
    for name, engine in table.names():
        kind = kinds()[name].under(engines(name)[engine].equation)
        for observable in OBSERVABLES:
            stated = (
                table.unmeasured(observable, kind, engine)
                or rules.undefined(observable, kind)
                or rules.unknown(observable, kind)
            )
            assert stated or table.right_parts(observable, kind), (name, engine, observable)


def test_the_sampled_values_are_of_the_scenes():
    assert {name: entry["recipe"]["scene"] for name, entry in values.stored().items()} == {
        name: kind.scene for name, kind in kinds().items()
    }


def test_every_feature_has_a_kind_of_scene():
    present = {f for kind in kinds().values() for f in Scene.from_dict(kind.scene).features}
    assert present | set(ELSEWHERE) == set(FEATURES)
    assert not present & set(ELSEWHERE)
    assert set(FACE_KINDS) <= set(FEATURES)


@pytest.mark.parametrize("engine", ENGINES)
def test_every_feature_of_an_engine_has_a_run(engine):
    runs = {"dsmc": ("dsmc", "enskog")}.get(engine, (engine,))
    present = {
        feature
        for kind in kinds().values()
        if set(runs) & set(engines(kind.name))
        for feature in Scene.from_dict(kind.scene).features
    }
    assert present >= ENGINES[engine].models - set(ELSEWHERE)


def test_every_observable_has_a_value_somewhere():
    valued = {
        observable
        for kind in kinds().values()
        for observable in OBSERVABLES
        if not rules.undefined(observable, kind) and not rules.unknown(observable, kind)
    }
    assert set(OBSERVABLES) - valued <= set(rules.LONG)
