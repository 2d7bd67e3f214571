"""The template of a Galton board: left and right are equal, and the grains stay near the middle."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.cli.new import templates
from gaspart.yaml_text import parse_yaml


@pytest.mark.thorough
def test_a_board_prefers_no_side_and_its_mirror_image_is_a_board():
    scene = gp.Scene.from_dict(parse_yaml(templates()["galton"].text))
    pins = scene.species[0].count
    middle = scene.container.lengths[0] / 2
    start = gp.Simulation(scene, "event", seed=1).initial_state
    places = start.positions[:pins]
    mirrored = places.copy()
    mirrored[:, 0] = (2.0 * middle - places[:, 0]) % (2.0 * middle)
    order = [np.lexsort(np.round(one.T, 6)) for one in (places, mirrored)]
    steps = np.diff(np.unique(np.round(places[:, 0], 6)))
    assert np.ptp(steps) < 1e-5  # columns of pins at equal distances: an image differs by a shift
    assert np.allclose(places[order[0], 1], mirrored[order[1], 1])
    ends = []
    for seed in range(1, 41):
        simulation = gp.Simulation(scene, "event", seed=seed)
        simulation.advance(duration=60.0)
        grains = simulation.state.positions[pins:]
        ends.append(grains[grains[:, 1] < 2.0, 0] - middle)  # few lie between pins
    means = np.array([end.mean() for end in ends])
    error = means.std(ddof=1) / len(means) ** 0.5
    assert abs(means.mean()) < 3.5 * error and error < 0.5
    away = np.concatenate(ends)
    assert len(away) > 0.9 * len(ends) * scene.species[1].count
    assert 2.0 < away.std() < 0.5 * middle / 3.0**0.5  # half of that of an even distribution
