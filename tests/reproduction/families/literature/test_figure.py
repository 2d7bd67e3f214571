import numpy as np
from reproduction.families.drawn import Points, draw, shows, varied
from reproduction.families.literature.data import beside_others

from gaspart.reproduction.families.literature.figure import LABELS, literature

STATIC = ("Z", "Z_crystal", "pressure")


def test_ratios_with_both_errors():
    ds = varied(beside_others(), "packing_fraction")
    static, transport = draw(literature, ds).axes
    for axis, wanted in ((static, True), (transport, False)):
        expected = []
        for name in LABELS:
            part = ds.isel(value=np.flatnonzero(ds["quantity"] == name))
            if (name in STATIC) != wanted:
                continue
            eta, theirs = part["packing_fraction"], part["theirs"]
            expected.append(Points(eta, 0.0 * eta, 100.0 * part["theirs_error"] / theirs))
            error = 100.0 * part["ours_error"] / theirs
            expected.append(Points(eta, 100.0 * (part["ours"] / theirs - 1.0), error))
        shows(axis, *expected)
