"""Compression: denser than insertion, without overlap, by exact contacts of growing particles."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import closest, gas

import gaspart as gp
from gaspart import compress
from gaspart.kernels.event.boxes import empty_lists
from gaspart.kernels.physics.contact import time_to_growing_contact
from gaspart.state import compression
from gaspart.state.boxes import make_boxes
from gaspart.state.initial import initial_state

number = st.floats(-3.0, 3.0).map(lambda x: round(x, 6))


@given(
    st.tuples(number, number, number),
    st.tuples(number, number, number),
    st.floats(0.1, 1.0),
    st.floats(0.0, 2.0),
)
def test_a_growing_root_is_the_first_touch(r, v, sigma, rate):
    """Against the gap |r + v t|^2 - (sigma + rate t)^2 in exact arithmetic: no touch before, one there."""
    rr, rv, vv = (sum(x * y for x, y in zip(a, b, strict=True)) for a, b in ((r, r), (r, v), (v, v)))
    if rr < 1.01 * sigma**2:
        return
    time = time_to_growing_contact(rr, rv, vv, sigma, rate)

    def gap(t):
        t = Fraction(t)
        reach = Fraction(sigma) + Fraction(rate) * t
        return sum((Fraction(x) + Fraction(y) * t) ** 2 for x, y in zip(r, v, strict=True)) - reach**2

    for part in np.linspace(0.0, 0.999 if time < math.inf else 1.0, 50):
        assert gap(part * min(time, 1e3)) > 0
    if time < 1e3:  # the touch lies within 1e-9 of that time: an allowance for a grazing one is its gap
        assert gap(time * (1 + 1e-9) + 1e-12) < 0 or abs(gap(time)) < 1e-9 * float((sigma + rate * time) ** 2)


@pytest.mark.parametrize(
    ("dimension", "fraction", "boundary"),
    [(3, 0.60, "periodic"), pytest.param(2, 0.80, "periodic", marks=pytest.mark.thorough), (3, 0.52, "wall")],
)
def test_compression_reaches_what_insertion_cannot(dimension, fraction, boundary):
    scene = gas(dimension, 500, fraction, boundary, arrangement="compressed")
    state = initial_state(scene, 1)
    assert closest(scene, state) >= 0
    low, high = scene.reach(0.5)
    assert (state.positions >= low).all()
    assert (state.positions <= high).all()
    sim = gp.Simulation(scene, gp.EventDriven(), seed=1)
    assert np.array_equal(sim.state.positions, state.positions)


def test_jammed_spheres_are_as_dense_as_random_packings():
    """Fast growth ends near 0.64 (Lubachevsky & Stillinger 1990), a mixture's a little above."""
    packing = compress(gas(3, 300, 0.3), 2, until="jammed", jammed=1e4)
    assert 0.61 < packing.packing_fraction < 0.66
    assert packing.pressure > 1e4
    scene = gas(3, 1, 0.3 / 300)
    kinds = [gp.Species(150, 0.5), gp.Species(150, 0.25)]
    mixed = replace(scene, species=kinds)
    packing = compress(mixed, 2, until="jammed", jammed=1e4)
    assert 0.62 < packing.packing_fraction < 0.70
    grown = [replace(kind, radius=kind.radius * packing.scale) for kind in kinds]
    grown = replace(mixed, species=grown)
    state = replace(initial_state(mixed, 2), radii=np.repeat([kind.radius for kind in grown.species], 150))
    assert closest(grown, replace(state, positions=packing.positions)) >= 0


def growing(scene, per_side=None):
    """A compression in progress, with so many boxes per side."""
    under_way = compression._Growing(scene, 3, 0.5, 1.0)
    if per_side:
        boxes = make_boxes(scene, per_side, images=True)
        under_way.boxes = empty_lists(boxes, scene.count)
        under_way.particles.predictions["box"] = boxes.coordinates(under_way.flights["position"])
    return under_way


@pytest.mark.parametrize("boundary", ["wall", "periodic"])
def test_boxes_change_no_bit_of_a_compression(boundary):
    """One box tests all pairs. Momentum is conserved but for walls, though every contact adds energy."""
    scene = gas(3, 60, 0.45, boundary)
    one, other = growing(scene), growing(scene, 1)
    for _ in range(4):
        for under_way in (one, other):
            under_way.grow(2.0**-4, 1.0)
        for key in ("position", "velocity", "radius"):
            assert np.array_equal(one.flights[key], other.flights[key])
    assert one.collisions > 1500
    velocities = one.flights["velocity"]
    assert (velocities**2).sum() > 3 * 60
    if boundary == "periodic":
        assert np.allclose(velocities.sum(axis=0), 0.0, atol=1e-12)


def test_what_cannot_be_compressed_is_refused():
    with pytest.raises(gp.SceneError, match="jam already at 0.6") as caught:
        compress(gas(3, 200, 0.72), 1)
    assert "\n" not in str(caught.value)
    with pytest.raises(gp.SceneError, match="shared by all particles"):
        replace(gas(3, 2, 0.1), species=[gp.Species(1, 0.5), gp.Species(1, 0.5, arrangement="compressed")])
    with pytest.raises(gp.SceneError, match="free to move"):
        compress(replace(gas(2, 5, 0.1), walls=[gp.Wall((0.0, 0.0), (1.0, 1.0))]))
