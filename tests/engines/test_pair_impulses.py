"""The tally of impulses of pairs: by its definition, contact by contact; its bits; scenes without it."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.state.tally import PairImpulseTally

ASKED = PairImpulseTally(1.6, 6, 0.4)
FLAT = gp.Scene(
    gp.Container((5.0, 4.0), "periodic"),
    [gp.Species(9, 0.3, temperature=1.0), gp.Species(5, 0.2, mass=3.0, temperature=1.0)],
)
CUBE = gp.Scene(gp.Container((7.0, 6.0, 5.0), "periodic"), [gp.Species(60, 0.5, temperature=1.0)])


def started(scene, search="boxes", asked=(ASKED,)):
    """A simulation, which keeps impulses of pairs."""
    return gp.Simulation(scene, gp.EventDriven(search=search), seed=3, tallies=list(asked))


def shells_of(distance, product, dimension):
    """(6,) what a pair at a distance gives to the mean over each shell, if it gives `product` / r^(d - 1) to
    all distances above its own."""
    edges = np.linspace(0.0, ASKED.furthest, ASKED.shells + 1) ** dimension
    above = np.clip((edges[1:] - distance**dimension) / np.diff(edges), 0.0, 1.0)
    return product / distance ** (dimension - 1) * above


def summed(scene, states):
    """(2, 6) the same of all contacts, from the states before and after each."""
    lengths, d = np.array(scene.container.lengths), scene.dimension
    found, contacts = np.zeros((2, ASKED.shells)), 0
    for before, after in itertools.pairwise(states):
        gained = after.masses[:, None] * (after.velocities - before.velocities)
        pair = np.flatnonzero(gained.any(axis=1))
        contacts += len(pair) == 2
        chosen = math.floor(contacts * ASKED.share) > math.floor((contacts - 1) * ASKED.share)
        for i in pair:
            for other in range(len(gained)):
                gap = after.positions[i] - after.positions[other]
                gap -= lengths * np.rint(gap / lengths)
                distance = math.hypot(*gap)
                meet = other in pair
                if other != i and distance < ASKED.furthest and (meet or chosen):
                    product = 0.5 * gained[i] @ gap / distance / (1.0 if meet else ASKED.share)
                    found[int(not meet)] += shells_of(distance, product, d)
    n = scene.count
    return found * scene.container.volume / (0.5 * n * (n - 1) * (2.0 * math.pi if d == 2 else 4.0 * math.pi))


@pytest.mark.thorough
def test_the_tally_is_what_contacts_give_to_pairs():
    simulation = started(FLAT, "pairs")
    simulation.advance(max_events=100)
    wanted = summed(FLAT, list(simulation.replay(by="event")))
    tally = simulation.tally
    assert np.abs(wanted[1]).max() > 0.1 and (np.diff(wanted[0]) >= 0.0).all()
    assert tally.contact_impulse_sum == pytest.approx(wanted[0], rel=1e-6, abs=1e-6)
    assert tally.other_impulse_sum == pytest.approx(wanted[1], rel=1e-6, abs=1e-6)


REFUSED = {
    "loses energy": replace(CUBE, restitution=gp.Restitution(0.9)),
    "periodic": replace(CUBE, container=gp.Container((7.0, 6.0, 5.0))),
    "half of the shortest side": replace(CUBE, container=gp.Container((20.0, 7.0, 3.0), "periodic")),
    "at least 2": replace(CUBE, species=[gp.Species(1, 0.5, temperature=1.0)]),
}


@pytest.mark.interpreted
@pytest.mark.parametrize("reason", REFUSED)
def test_scenes_of_which_impulses_give_no_g_are_refused(reason):
    with pytest.raises(gp.SceneError, match=reason):
        started(REFUSED[reason])


@pytest.mark.interpreted
def test_texts_that_are_no_distance_shells_and_share_are_refused():
    assert PairImpulseTally.from_text("3:300") == PairImpulseTally(3.0, 300, 1.0)
    assert PairImpulseTally.from_text(ASKED.to_text()) == ASKED
    for text in ("3", "3:", "x:300", "3:300:0.5:1", "0:300", "3:1", "3:300:0", "3:300:1.5", "3:2.5"):
        with pytest.raises(gp.SceneError, match="pair_impulses"):
            PairImpulseTally.from_text(text)
