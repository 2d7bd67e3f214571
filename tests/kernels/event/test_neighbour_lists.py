"""Neighbour lists: complete at any time, and the same events as every other search."""

import numpy as np
import pytest
from referee import WORK, check_same, events_of, same_bits
from scenes import gas

import gaspart as gp
from gaspart.engines.event import search as event_search
from gaspart.engines.event.search import chosen_search, distances
from gaspart.kernels.model import NUMBER_BITS


def lists_of(sim):
    return sim._dynamics._boxes.lists


def listed(sim):
    """The pairs (i, j) in the lists of a simulation."""
    lists = lists_of(sim)
    rows = lists.candidates[: sim.scene.count * lists.room].reshape(-1, lists.room)
    numbers = rows & ((1 << NUMBER_BITS) - 1)
    return {(i, int(j)) for i, row in enumerate(numbers) for j in row[1 : 1 + rows[i, 0]]}


def separations(sim, points):
    """(N, N) distances between points, of the nearest images."""
    container = sim.scene.container
    gaps = points[:, None] - points[None]
    for k, (length, periodic) in enumerate(zip(container.lengths, container.periodic, strict=True)):
        if periodic:
            gaps[..., k] -= length * np.round(gaps[..., k] / length)
    return np.linalg.norm(gaps, axis=2)


@pytest.mark.thorough
@pytest.mark.parametrize("boundary", ["periodic", "wall", ("periodic", "wall", "periodic")])
@pytest.mark.parametrize("dimension", [2, 3])
def test_lists_hold_exactly_what_the_centres_say(dimension, boundary):
    boundary = boundary if isinstance(boundary, str) else boundary[:dimension]
    check_lists(gas(dimension, 300, 0.3, boundary), 700)


@pytest.mark.interpreted
@pytest.mark.parametrize("lengths", [(8.0, 6.0), (5.0, 6.5, 7.5)])
def test_lists_are_complete_in_uneven_containers(lengths):
    check_lists(gp.Scene(gp.Container(lengths, "periodic"), [gp.Species(16, 0.5, temperature=1.0)]), 8)


def check_lists(scene, events):
    """Compare the lists with the distances between their centres, five times after as many events."""
    dimension, sim = scene.dimension, gp.Simulation(scene, gp.EventDriven("lists"), seed=4)
    margin, reach = distances(scene)
    for _ in range(5):
        sim.advance(max_events=events)
        centres = lists_of(sim).listed["centre"][:, :dimension]
        apart = separations(sim, centres)
        np.fill_diagonal(apart, np.inf)
        assert listed(sim) == {(i, j) for i, j in np.argwhere(apart < reach).tolist()}
        moved = sim.state.positions - centres
        lengths = np.array(scene.container.lengths)
        moved -= np.where(scene.container.periodic, lengths * np.round(moved / lengths), 0.0)
        assert np.linalg.norm(moved, axis=1).max() < margin * (1 + 1e-9)


@pytest.mark.thorough
def test_lists_and_cells_grow_when_they_are_full():
    """Small particles among large ones are more than there is room for at first."""
    species = [gp.Species(2, 1.5, temperature=1.0), gp.Species(900, 0.1, temperature=1.0)]
    scene = gp.Scene(gp.Container((14.0, 14.0)), species)
    sim = gp.Simulation(scene, gp.EventDriven("lists"), seed=1)
    assert lists_of(sim).room > 16
    assert lists_of(sim).per_cell > 1
    assert same_bits(events_of(scene, "boxes", 4000), events_of(scene, "lists", 4000))


def test_room_that_is_lacking_on_the_way_is_made(monkeypatch):
    """On the lattice all lists are equally long; in the fluid some become longer."""
    scene = gas(2, 300, 0.6, arrangement="lattice")
    lists = lists_of(gp.Simulation(scene, gp.EventDriven("lists"), seed=1))
    room = 1 + int(lists.candidates[: scene.count * lists.room : lists.room].max())
    monkeypatch.setitem(event_search._ROOM, 2, room)
    assert lists_of(gp.Simulation(scene, gp.EventDriven("lists"), seed=1)).room == room
    sim, other = (gp.Simulation(scene, gp.EventDriven(search), seed=1) for search in ("lists", "boxes"))
    for one in (sim, other):
        one.advance(max_events=5000)
    assert lists_of(sim).room > room
    check_same(sim, other, WORK)


@pytest.mark.parametrize(
    ("dimension", "eta", "chosen"),
    [(2, 0.3, "boxes"), (2, 0.7, "lists"), (3, 0.2, "boxes"), (3, 0.45, "lists")],
)
def test_the_engine_chooses_by_density(dimension, eta, chosen):
    scene = gas(dimension, 1000, eta, arrangement="lattice")
    assert chosen_search(scene, "automatic", False) == chosen
    assert chosen_search(scene, "automatic", True) == "boxes"


@pytest.mark.interpreted
def test_what_lists_do_not_support_is_refused():
    species = [gp.Species(5, 0.5, temperature=1.0)]
    falling = gp.Scene(gp.Container((12.0, 12.0)), species, gravity=(0.0, -1.0))
    short = gp.Scene(gp.Container((3.0, 12.0), "periodic"), species)
    for scene, what in [(falling, "gravity"), (short, "so short a periodic axis")]:
        with pytest.raises(gp.SceneError, match=f"search = 'lists'.*{what}"):
            gp.Simulation(scene, gp.EventDriven("lists"), seed=1)


def test_more_particles_than_a_search_can_number_are_refused():
    species = gp.Species(count=2**NUMBER_BITS + 1, radius=0.001, speed=1.0)
    scene = gp.Scene(gp.Container((1e6,) * 3), species=[species])
    with pytest.raises(gp.SceneError, match="species = 67108865: .* at most 67108864 particles"):
        chosen_search(scene, "automatic", False)
