from reproduction.families.drawn import Points, draw, follows, shows
from reproduction.families.settling.data import settled

from gaspart.reproduction.families.settling import figure


def test_four_panels():
    ds = settled()
    energies, contacts, left, rates = draw(figure.settling, ds).axes
    moving = ds["kinetic"].values > 0.0
    for curve, n in zip([one for one in energies.lines if len(one.get_xdata()) > 2], (0, 3), strict=True):
        follows(curve, ds["time"][n][moving[n]], ds["kinetic"][n][moving[n]])
    curves = [one for one in contacts.lines if len(one.get_xdata()) == ds.sizes["frame"]]
    for curve, n in zip(curves, (0, 3), strict=True):
        follows(curve, ds["time"][n], ds["contacts"][n])
    for n, curve in enumerate(left.lines[:4]):
        follows(curve, ds["flow_time"][n], ds["left"][n])
    shows(rates, Points(ds["width"] - ds["beverloo_offset"], ds["rate"], ds["rate_error"]))
