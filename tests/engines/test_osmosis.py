"""Osmosis of the template: with point particles the osmotic pressure is exactly that of the large discs."""

from dataclasses import replace

import numpy as np
import pytest

import gaspart as gp
from gaspart import theory
from gaspart.cli.new import templates
from gaspart.yaml_text import parse_yaml

BLOCKS, BLOCK = 40, 1500.0


@pytest.mark.thorough
def test_the_osmotic_pressure_is_the_pressure_of_the_large_discs_alone():
    """Points have one density in the free space of both sides; large discs feel only each other."""
    scene = gp.Scene.from_dict(parse_yaml(templates()["osmosis"].text))
    solute, solvent = scene.species
    scene = replace(scene, species=[solute, replace(solvent, radius=0.01)])
    length, width = scene.container.lengths
    simulation = gp.Simulation(scene, "event", seed=1)
    simulation.advance(duration=BLOCK)
    given, on_the_left = [], []
    for _ in range(BLOCKS):
        before = simulation.tally.wall_impulse[:2].copy()
        simulation.advance(duration=BLOCK)
        given.append(np.abs(simulation.tally.wall_impulse[:2] - before) / (BLOCK * width))
        on_the_left.append((simulation.state.positions[solute.count :, 0] < length / 2).mean())
    left, right = np.array(given).T
    measured, error = (right - left).mean(), (right - left).std(ddof=1) / BLOCKS**0.5
    diameter = 2.0 * solute.radius
    density = solute.count / ((length / 2 - diameter) * width)
    side, reduced = length / 2 / diameter, density * diameter**2
    exact = theory.wall_pressure(side, reduced, solute.count, 2, 1)[0] / diameter**2
    assert abs(measured - exact) < 4.0 * error and error < 0.04 * exact
    assert measured - density > 8.0 * error  # van 't Hoff's law alone
    free = length / 2 * width - solute.count * np.pi * solute.radius**2
    share = length / 2 * width / (length / 2 * width + free)
    error = np.std(on_the_left, ddof=1) / BLOCKS**0.5
    assert abs(np.mean(on_the_left) - share) < 4.0 * error and error < 0.02
