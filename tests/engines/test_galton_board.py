"""The template of a Galton board: left and right are equal, and the grains stay near the middle."""

import numpy as np
import pytest

import gaspart as gp
from gaspart.cli.new import templates
from gaspart.yaml_text import parse_yaml


@pytest.mark.thorough
def test_a_board_prefers_no_side():
    scene = gp.Scene.from_dict(parse_yaml(templates()["galton"].text))
    pins = scene.species[0].count
    middle = scene.container.lengths[0] / 2
    columns, rows = np.unique(
        np.round(gp.Simulation(scene, "event", seed=1).initial_state.positions[:pins], 5), axis=0
    ).T
    for row in np.unique(rows):  # the mirror image of a row is the row
        places = np.sort(columns[rows == row])
        assert np.ptp(np.diff(places)) < 1e-4 and len(places) == pins // 14
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
