import numpy as np
import pytest
import xarray as xr
from reproduction.families.drawn import draw

from gaspart.reproduction.families.pictures import figure as pictures


@pytest.fixture
def dataset():
    rng = np.random.default_rng(1)
    return xr.Dataset(
        {
            "position": (("particle", "axis"), rng.uniform(1, 9, (20, 3))),
            "radius": ("particle", rng.uniform(0.4, 0.6, 20)),
            "species": ("particle", np.arange(20) // 19),
            "speed": ("particle", rng.uniform(0, 2, 20)),
            "length": ("axis", np.array([10.0, 11.0, 12.0])),
        }
    )


@pytest.mark.parametrize("function", [pictures.gas_render, pictures.brownian_render])
def test_the_picture_is_drawn_with_a_pixel_for_each_dot(dataset, function):
    figure = draw(function, dataset)
    image = figure.axes[0].images[0].get_array()
    assert image.shape == (1260, 1680, 3)
    saturated = np.ptp(image.astype(int), axis=-1) > 60
    assert 0.002 < saturated.mean() < 0.5


@pytest.mark.parametrize(
    ("function", "colour"), [(pictures.gas_render, "speed"), (pictures.brownian_render, "species")]
)
def test_the_particles_of_the_data_set_are_drawn(monkeypatch, dataset, function, colour):
    drawn, coloured = [], []

    def picture(particles, size, colours):
        drawn.append(particles)
        return np.zeros((*size[::-1], 3), dtype=np.uint8)

    monkeypatch.setattr(pictures, "picture", picture)
    monkeypatch.setattr(pictures, "colours_of", lambda particles, by: coloured.append(by))
    figure = draw(function, dataset)
    particles = drawn[-1]
    assert coloured == [colour]
    columns = {"positions": "position", "radii": "radius", "species": "species", "speeds": "speed"}
    for name, column in {**columns, "lengths": "length"}.items():
        assert np.array_equal(getattr(particles, name), dataset[column])
    fastest = pictures.FASTEST * float(np.sqrt((dataset["speed"] ** 2).mean()))
    scales = [scale.get_xlim() for scale in figure.axes[1:]]
    assert scales == ([pytest.approx((0.0, fastest))] if colour == "speed" else [])
