"""The sampler against closed formulas."""

import math

import numpy as np
import pytest
import yaml
from exact import closed, static
from exact.bodies import Case
from exact.sampler import block_mean, inserted, sample

pytestmark = pytest.mark.thorough


def case(text):
    return Case(yaml.safe_load(text))


def close(value, error, right, sigmas=4.0, relative=0.03):
    """Raise AssertionError unless a value with a small error is the right one."""
    assert error < relative * max(abs(right), 1e-12), (value, error)
    assert value == pytest.approx(right, abs=sigmas * error)


def test_two_discs_have_the_z_of_two_discs():
    two = case("{container: {lengths: [3, 3], boundary: periodic}, species: [{count: 2, radius: 0.5}]}")
    right = closed.two_body_z(2, 1.0, 9.0)
    value, error = static.contacts(two, 2000)
    close(1.0 + value[0, 5] / 4.0, error[0, 5] / 4.0, right)
    kept = sample(two, 30_000)
    (z, scatter), _ = static.scaled_pairs(two, kept)
    close(z, scatter, right)


def test_a_loaded_piston_on_points_has_their_mean_length():
    text = "{container: {lengths: [60, 2]}, centres_to_walls: true, species: [{count: 3, radius: 1.0e-9}],"
    loaded = case(text + "faces: {x_high: {kind: piston, mass: 1, pressure: 0.5}}}")
    kept = sample(loaded, 20_000)
    close(*block_mean(kept.places), 4.0, relative=0.06)  # (N + 1) / load
    value, error = static.contacts(loaded, 24_000)
    close(value[0, 2], error[0, 2], 1.0)


def test_a_wall_between_points_is_where_the_numbers_of_both_sides_are():
    text = (
        "{container: {lengths: [4, 2]}, centres_to_walls: true,"
        "walls: [{start: [2, 0], end: [2, 2], mass: 1}],"
        "species: [{count: 2, radius: 1.0e-9, region: [[0, 0], [2, 2]]},"
        "{count: 5, radius: 1.0e-9, region: [[2, 0], [4, 2]]}]}"
    )
    kept = sample(case(text), 20_000)
    close(*block_mean(kept.places / 4.0), 3.0 / 9.0)  # a beta distribution


def test_places_between_open_faces_are_filled_as_the_grand_sum_says():
    text = "container: {lengths: [0.6, 1.05], boundary: [wall, periodic]}, centres_to_walls: true,"
    text += "species: [{count: 1, radius: 0.5}], faces: {x_low: {kind: open, activity: 1.0},"
    one = case("{" + text + "x_high: {kind: open, activity: 1.0}}}")
    z = 4.0 / math.pi
    close(*block_mean(sample(one, 30_000).numbers.astype(float)), closed.one_place_number(z, 0.63))
    value, error = static.contacts(one, 5000)
    close(value[0, 1] / 1.05, error[0, 1] / 1.05, z / (1.0 + z * 0.63))


def test_the_number_between_open_faces_is_that_of_the_trial_bodies():
    text = "{container: {lengths: [2, 3]}, centres_to_walls: true, species: [{count: 1, radius: 0.1}], faces:"
    text += "{x_low: {kind: open, activity: 0.0314159265}, x_high: {kind: open, activity: 0.0314159265}}}"
    many = case(text)
    kept = sample(many, 20_000)
    apart, error = block_mean(kept.numbers - many.activity * inserted(many, kept, 0, 30, 1)[:, 0])
    assert error < 0.05
    assert abs(apart) < 4.0 * error


def test_fields_have_the_density_of_boltzmann_at_a_face():
    falling = case(
        "{container: {lengths: [2, 3]}, species: [{count: 1, radius: 1.0e-9, mass: 2}], gravity: [0, -0.7]}"
    )
    value, error = static.contacts(falling, 5000)
    close(value[0, 3], error[0, 3], 1.4 / (1.0 - math.exp(-4.2)))
    text = "{container: {lengths: [2, 3], boundary: [wall, periodic]}, species: [{count: 1, radius: 1.0e-9}],"
    bound = case(text + "faces: {x_low: {kind: well, depth: 1.0, width: 0.5}}}")
    value, error = static.contacts(bound, 5000)
    close(value[0, 1], error[0, 1], math.e / (0.5 * math.e + 1.5))


def test_an_obstacle_and_a_wall_leave_the_room_of_geometry():
    text = "{container: {lengths: [4, 4]}, species: [{count: 1, radius: 0.5}],"
    text += "particles: [{position: [2, 2], radius: 0.5, fixed: true}],"
    parted = case(text + "walls: [{start: [0.0, 3.5], end: [4.0, 3.5]}]}")
    value, error = static.room(parted, 0)
    close(value[0], error[0], 7.5 - math.pi)


def test_a_disc_hits_obstacles_as_often_as_santalo_says():
    text = "{container: {lengths: [6, 6], boundary: periodic}, species: [{count: 1, radius: 0.1}], particles:"
    text += "[{position: [1, 1], radius: 1.0, fixed: true}, {position: [4, 3], radius: 1.2, fixed: true}]}"
    value, error = static.contacts(case(text), 8000)
    speed = closed.speed_factor(2) / math.sqrt(2.0 * math.pi)  # of a component, half of it inwards
    surface, room = 2.0 * math.pi * 2.4, 36.0 - math.pi * (1.1**2 + 1.3**2)
    right = closed.santalo_rate(2, math.sqrt(2.0), surface, room)
    close(value[0, -1] * speed, error[0, -1] * speed, right)


def test_lattices_have_their_order():
    plane = case("{container: {lengths: [6, 5.196152422706632], boundary: periodic}, species: []}")
    x = np.array([[i + j / 2 % 1, j * math.sqrt(0.75)] for i in range(6) for j in range(6)])
    assert static.hexatic_order(plane, x[None])[0] == pytest.approx(1.0, abs=1e-6)
    cubic = case("{container: {lengths: [3, 3, 3], boundary: periodic}, species: []}")
    basis = np.array([[0, 0, 0], [0, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0]])
    x = np.concatenate([basis + np.array([i, j, k]) for i in range(3) for j in range(3) for k in range(3)])
    assert static.steinhardt_order(cubic, x[None])[0] == pytest.approx(0.57452, abs=1e-5)


def test_points_between_walls_forget_where_they_were():
    x, v = closed.free_correlation([0.0, 1e6], 3.0, 2.0, 1.5, None)
    assert x == pytest.approx([3.0**2 / 12.0, 0.0], abs=1e-4)
    assert v == pytest.approx([0.75, 0.0], rel=0.01, abs=1e-6)
    rng = np.random.default_rng(3)
    q, u = rng.random(200_000) * 3.0, rng.standard_normal((200_000, 4))
    u = math.sqrt(4 * 0.75) * (u / np.sqrt((u**2).sum(axis=1, keepdims=True)))[:, 0]
    later = (q + 2.0 * u) % 6.0
    folded, sign = np.where(later > 3.0, 6.0 - later, later), np.where(later > 3.0, -1.0, 1.0)
    x, v = closed.free_correlation([2.0], 3.0, 2.0, 1.5, 4)
    for right, found in ((x[0], (q - 1.5) * (folded - 1.5)), (v[0], u * u * sign)):
        assert found.mean() == pytest.approx(right, abs=4.0 * found.std() / math.sqrt(200_000))


def test_free_flight_between_plates_of_full_accommodation_is_the_textbook_one():
    gas = closed.FreeMolecular(2, 0.3, 2.0, (1.0, 3.0))
    stay = math.sqrt(math.pi) * (1.0 + 3.0**-0.5)
    assert gas.rate == pytest.approx(0.3 / stay)
    assert gas.heat_flux == pytest.approx(-gas.rate * 3.0)
    half = closed.FreeMolecular(2, 0.3, 2.0, (1.0, 1.0), (0.0, 0.6), (0.5, 0.5))
    full = closed.FreeMolecular(2, 0.3, 2.0, (1.0, 1.0), (0.0, 0.6))
    assert half.stress == pytest.approx(full.stress * 0.5 / 1.5)  # alpha / (2 - alpha)
    assert half.pressure == pytest.approx(0.3)
