import numpy as np
from reproduction.families.drawn import Points, draw, follows, line, shows
from reproduction.families.settling.data import settled

from gaspart.reproduction.families.settling import figure


def test_four_panels():
    ds = settled()
    energies, contacts, left, rates = draw(figure.settling, ds).axes
    moving = ds["kinetic"].values > 0.0
    for n, duration in ((0, "0.003"), (3, "0.01")):
        row = ds.isel(pile=n)
        follows(line(energies, duration), row["time"][moving[n]], row["kinetic"][moving[n]])
    curves = [one for one in contacts.lines if len(one.get_xdata()) == ds.sizes["frame"]]
    for curve, n in zip(curves, (0, 3), strict=True):
        follows(curve, ds["time"][n], ds["contacts"][n])
    for n, curve in enumerate(left.lines[:4]):
        follows(curve, ds["flow_time"][n], ds["left"][n])
        assert f"{float(ds['width'][n]):.3g}" in curve.get_label()
    apart = ds["width"] - ds["beverloo_offset"]
    shows(rates, "D/d", "rate of flow", Points("measured", apart, ds["rate"], ds["rate_error"]))
    law = line(rates, "Beverloo")
    x, y = (np.asarray(values) for values in law.get_data())
    assert np.allclose(y, float(ds["beverloo_amplitude"]) * x**1.5)
    assert np.allclose(np.interp(apart, x, y)[:1], ds["rate"][:1], rtol=0.3)
