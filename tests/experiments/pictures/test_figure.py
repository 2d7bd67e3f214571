import numpy as np
import pytest
import xarray as xr

from gaspart.experiments.pictures import figure as pictures
from gaspart.rendering import style


@pytest.mark.parametrize("draw", [pictures.gas_render, pictures.brownian_render])
def test_the_picture_fills_a_column(tmp_path, draw):
    rng = np.random.default_rng(1)
    ds = xr.Dataset({
        "position": (("body", "axis"), rng.uniform(1, 9, (20, 3))),
        "radius": ("body", np.full(20, 0.5)),
        "species": ("body", np.arange(20) // 19),
        "speed": ("body", rng.uniform(0, 2, 20)),
        "length": ("axis", np.full(3, 10.0)),
    })  # fmt: skip
    with style.applied():
        figure = draw(ds)
        style.save(figure, tmp_path / "picture.png")
    image = figure.axes[0].images[0].get_array()
    assert image.shape == (765, 1020, 3)
    assert len(figure.axes) == (2 if draw is pictures.gas_render else 1)
    saturated = np.ptp(image.astype(int), axis=-1) > 60
    assert 0.002 < saturated.mean() < 0.5
