"""Statements of the source documents: each has a verdict; corrected formulas differ from the printed ones."""

import re
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest

import gaspart as gp
from gaspart.kernels.physics.contact import contact_root, exchange, tangential_impulse
from gaspart.reproduction.jobs.pack import GROWTH
from gaspart.reproduction.registry import families
from gaspart.reproduction.report.page import statements
from gaspart.state.compression import compress
from gaspart.yaml_text import read_yaml

ROOT = Path(__file__).parents[1]
DOCUMENTS = read_yaml(ROOT / "workflow/report/sources.yaml")
VERDICTS = {"confirmed", "corrected", "contradicted", "open", "followed", "replaced"}


def test_each_statement_has_a_verdict_and_evidence_that_exists():
    keys = {key for document in DOCUMENTS for entry in document["statements"] for key in entry}
    assert keys == {"at", "verdict", "figure", "says", "why"}
    known = read_yaml(ROOT / "workflow/report/references.yaml")
    shown = statements(DOCUMENTS, [])
    assert len(shown) >= 90 and {one["source"] for one in shown} == {"source A", "source B", "source C"}
    for one in shown:
        assert one["verdict"] in VERDICTS and one["at"] and one["says"] and one["why"], one
        assert one["figure"] in {"", *families()}, one
        assert set(re.findall(r"\[([A-Z][a-z]+ \d{4})\]", one["why"])) <= set(known), one
        assert "{{" not in one["why"] or one["figure"], one


def test_measured_numbers_are_filled_in():
    documents = [
        {
            "source": "source A",
            "statements": [{"at": "§1", "says": "x", "verdict": "open", "figure": "f", "why": "{{a}}"}],
        }
    ]
    (one,) = statements(documents, [{"figure": "f", "claim": "a b", "measured": 0.93, "uncertainty": 0.02}])
    assert one["why"] == "0.93(2)"


def test_the_time_of_contact_is_twice_that_of_equation_21_of_source_c():
    # centres 2 apart, sum of the radii 1, closing speed 1
    rr, rv, vv, ss = 4.0, -2.0, 1.0, 1.0
    a, b, c = vv, 2.0 * rv, rr - ss
    printed = c / (-b + sqrt(b * b - 4.0 * a * c))
    assert contact_root(rr, rv, vv, ss) == 1.0 and printed == 0.5


def test_the_root_of_source_a_is_the_time_of_separation():
    # at rest 0.5 inside contact, approaching with speed 1: touched 0.5 ago, separates after 1.5
    rr, rv, vv, ss = 0.25, -0.5, 1.0, 1.0
    printed = (-rv + sqrt(rv * rv + vv * (ss - rr))) / vv
    assert contact_root(rr, rv, vv, ss) == -0.5 and printed == 1.5


def collide(mass1, mass2, v1, v2, separation):
    rr, rv = separation @ separation, separation @ (v2 - v1)
    k1, k2 = exchange(rr, rv, mass1, mass2)
    return v1 + k1 * separation, v2 - k2 * separation


def test_momenta_and_parallel_components_of_a_collision_are_not_the_printed_ones_of_source_b():
    masses, separation = (1.0, 3.0), np.array([0.6, 0.8])
    v1, v2 = np.array([1.0, 0.5]), np.array([-0.25, 0.125])
    w1, w2 = collide(*masses, v1, v2, separation)
    centre = (masses[0] * v1 + masses[1] * v2) / sum(masses)
    assert np.allclose(masses[0] * (w1 - centre) + masses[1] * (w2 - centre), 0.0)  # eq. 13 in v - w
    assert np.linalg.norm(masses[0] * w1 + masses[1] * w2) > 0.1  # as printed, in v
    across = np.array([-separation[1], separation[0]])
    assert np.allclose((w1 - v1) @ across, 0.0) and abs((w1 - v1) @ separation) > 0.1  # text after eq. 15
    factor = 2.0 * masses[1] / sum(masses) * ((v2 - v1) @ separation) / (separation @ separation)
    assert np.allclose(w1 - v1, factor * separation)  # eq. 16 with its vector


def test_one_dimensional_velocities_of_source_a_are_those_of_v1_and_v2():
    (w1,), (w2,) = collide(1.0, 3.0, np.array([2.0]), np.array([-1.0]), np.array([1.0]))
    assert (w1, w2) == ((2.0 * (1.0 - 3.0) + 2.0 * 3.0 * -1.0) / 4.0, (-1.0 * (3.0 - 1.0) + 2.0 * 2.0) / 4.0)


@pytest.mark.thorough
def test_slowly_growing_spheres_pass_63_per_cent_and_end_at_the_densest_packing():
    side = (108 * pi / 6.0 / 0.6) ** (1.0 / 3.0)
    container = gp.Container(lengths=(side, side, side), boundary="periodic")
    scene = gp.Scene(
        container=container, species=[gp.Species(count=108, radius=0.5, arrangement="compressed")]
    )
    packing = compress(scene, (2,), GROWTH / 32.0, until="jammed")
    assert packing.packing_fraction == pytest.approx(pi / sqrt(18.0), abs=1e-5)  # [Hales 2005]


@pytest.mark.parametrize("restitution", [-0.5, 0.5, 1.0])
def test_the_tangential_velocity_after_a_collision_is_not_zero_as_equation_22_of_source_c_implies(
    restitution,
):
    # printed: g' x s = -e g' x s, so g' x s = 0 for e != -1
    inverse_mass, lever, before = 1.0 / 2.0 + 1.0 / 3.0, 4.0, 1.25
    impulse = tangential_impulse.py_func(inverse_mass, lever, restitution) * before
    after = before - (inverse_mass + lever) * impulse
    assert after == pytest.approx(-restitution * before) and abs(after) > 0.1
