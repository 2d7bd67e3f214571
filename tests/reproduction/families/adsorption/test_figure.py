import numpy as np
from reproduction.families.adsorption.data import walls
from reproduction.families.drawn import Points, column, draw, lines, obeys, shows, varied

from gaspart.reproduction.families.adsorption.figure import adsorption
from gaspart.theory.adsorption import flux_density, scaled_particle_activity, well_ratio


def test_the_panels_show_the_columns_of_the_data_set():
    ds = varied(walls(), "depth", "width")
    ratios, deviations, lengths, layer, coverage, leaving = draw(adsorption, ds).axes
    wells = [ds.isel(point=slice(0, 4)), ds.isel(point=slice(4, 8))]
    tops, bottoms = [], []
    for kind, row in enumerate(wells):
        depth, width, outside = (float(row[name][0]) for name in ("depth", "width", "outside"))
        inverse = 1.0 / row["temperature"]
        label = f"$\\epsilon$ = {depth:g}"
        tops.append(Points(label, inverse, row["ratio"], row["ratio_error"]))
        exact = np.log(well_ratio(depth * inverse, width, outside))
        deviation = 100.0 * (row["log_ratio"] - exact)
        bottoms.append(Points(None, inverse + 0.02 * (kind - 1), deviation, 100.0 * row["log_ratio_error"]))
        obeys(lines(ratios)[kind], lambda x, a=depth, w=width, v=outside: well_ratio(a * x, w, v))
    shows(ratios, "", "ads", *tops)
    shows(deviations, "1/kT", "exact", *bottoms)
    width = 0.2
    shows(
        lengths, "temperature", "lambda",
        *(
            Points(None, row["temperature"], row["length"] / width, row["length_error"] / width)
            for row in wells
        ),
    )  # fmt: skip
    own = ds.isel(point=slice(8, 11))
    spheres = Points(
        "spheres", own["activity"], own["coverage"], own["coverage_error"], own["activity_error"]
    )
    shows(layer, "P/kT", "coverage", spheres)
    x, y = lines(layer)[0].get_data()
    np.testing.assert_allclose(scaled_particle_activity(y), x)
    sticky = ds.isel(point=slice(11, 14))
    shows(coverage, "density", "coverage", column(sticky, "sticky wall", "gas_density", "coverage"))
    densest = sticky.isel(point=int(sticky["gas_density"].values.argmax()))
    shows(
        leaving, "normal speed", "share", column(ds.isel(point=0), "well", "speed", "flux"),
        column(densest, "sticky wall", "speed", "flux"),
    )  # fmt: skip
    obeys(lines(leaving)[0], flux_density)
