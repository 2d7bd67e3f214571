"""Lorentz gas of the template: the mean path of a billiard follows from its area and perimeter."""

import math
from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart.cli.new import templates
from gaspart.yaml_text import parse_yaml


def test_the_mean_path_among_fixed_discs_is_pi_times_area_over_perimeter():
    """Of one moving disc: exact for every ergodic billiard (Santaló)."""
    scene = gp.Scene.from_dict(parse_yaml(templates()["lorentz"].text))
    fixed, moving = scene.species
    simulation = gp.Simulation(replace(scene, species=[fixed, replace(moving, count=1)]), "event", seed=1)
    speed = np.linalg.norm(simulation.state.velocities[-1])
    simulation.advance(max_events=40_000)
    reach = fixed.radius + moving.radius
    perimeter = 2.0 * math.pi * reach * fixed.count
    area = math.prod(scene.container.lengths) - math.pi * reach**2 * fixed.count
    path = speed * simulation.time / simulation.tally.fixed_collisions
    assert path == pytest.approx(math.pi * area / perimeter, rel=0.01)
    assert np.linalg.norm(simulation.state.velocities[-1]) == pytest.approx(speed, rel=1e-9)
