import numpy as np
from reproduction.families.adsorption.data import walls
from reproduction.families.drawn import Points, column, draw, shows, varied

from gaspart.reproduction.families.adsorption.figure import adsorption
from gaspart.theory.adsorption import well_ratio


def test_the_panels_show_the_columns_of_the_data_set():
    ds = varied(walls(), "depth", "width")
    ratios, deviations, lengths, layer, coverage, leaving = draw(adsorption, ds).axes
    wells = [ds.isel(point=slice(0, 4)), ds.isel(point=slice(4, 8))]
    tops, bottoms = [], []
    for kind, row in enumerate(wells):
        depth, width, outside = (float(row[name][0]) for name in ("depth", "width", "outside"))
        inverse = 1.0 / row["temperature"]
        tops.append(Points(inverse, row["ratio"], row["ratio_error"]))
        deviation = 100.0 * (row["log_ratio"] - np.log(well_ratio(depth * inverse, width, outside)))
        bottoms.append(Points(inverse + 0.02 * (kind - 1), deviation, 100.0 * row["log_ratio_error"]))
    shows(ratios, *tops)
    shows(deviations, *bottoms)
    width = 0.2
    shows(
        lengths,
        *(Points(row["temperature"], row["length"] / width, row["length_error"] / width) for row in wells),
    )
    own = ds.isel(point=slice(8, 11))
    shows(layer, Points(own["activity"], own["coverage"], own["coverage_error"], own["activity_error"]))
    sticky = ds.isel(point=slice(11, 14))
    shows(coverage, column(sticky, "gas_density", "coverage"))
    densest = sticky.isel(point=int(sticky["gas_density"].values.argmax()))
    shows(leaving, column(ds.isel(point=0), "speed", "flux"), column(densest, "speed", "flux"))
