from experiments.reversibility.data import measurement

from gaspart.experiments.reversibility import figure as reversibility
from gaspart.rendering import style


def test_echoes_growth_and_memory(tmp_path):
    with style.applied():
        figure = reversibility.reversibility(measurement(tmp_path))
        style.save(figure, tmp_path / "figure.png")
    echoes, growth, memory = figure.axes
    assert len(echoes.lines) == 2
    assert "growth" in growth.get_ylabel() and "memory" in memory.get_ylabel()
