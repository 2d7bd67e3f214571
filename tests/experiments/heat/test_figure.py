import numpy as np
from experiments.heat.data import gases, metals

from gaspart.experiments.heat import figure as heat
from gaspart.rendering import style


def test_the_flux_is_drawn_between_its_limits_and_profiles_with_theory(tmp_path):
    ds = gases()
    with style.applied():
        figure = heat.heat_conduction_gas(ds)
        style.save(figure, tmp_path / "heat.png")
    flux, share, warm, off, dense = figure.axes
    free, fourier = flux.lines[0].get_ydata(), flux.lines[1].get_ydata()
    assert np.all(flux.lines[2].get_ydata() < np.minimum(free, fourier[0]))
    for axis, name in ((warm, "slab_temperature"), (dense, "slab_density")):
        theory = ds[name].values[0] / (0.04 if axis is dense else 1.0)
        assert any(np.array_equal(line.get_ydata(), theory) for line in axis.lines)
    assert len(share.containers) == 4
    assert len(off.containers) == 1


def test_the_metal_is_drawn_with_dulong_and_petit(tmp_path):
    with style.applied():
        figure = heat.heat_conduction_metal(metals())
        style.save(figure, tmp_path / "metal.png")
    top, bottom, _ = figure.axes
    line, frozen = bottom.lines[0], bottom.lines[-1]
    assert np.array_equal(line.get_xdata(), line.get_ydata())
    assert np.allclose(frozen.get_ydata(), 5 / 9 * frozen.get_xdata())
    assert len(top.containers) == 2
