import numpy as np
from reproduction.families.drawn import Points, draw, follows, line, lines, obeys, shows, varied
from reproduction.families.gravity.data import capacities, columns, with_source

from gaspart.reproduction.families.gravity import figure as gravity
from gaspart.theory.gravity import ideal_heat_capacity, ideal_profile
from gaspart.theory.state import compressibility_factor


def ideal(row, kind):
    """(B,) density of an ideal gas with the mean density, the mass and the temperature of the column's."""
    own = row.isel(species=kind)
    top = float(own["top"])
    weight = float(own["mass"] * own["strength"] / own["temperature"])
    return float(own["density"].mean()) * top * ideal_profile(own["height"].values, top, weight)


def profile(row, kind, label):
    """Density of a species over the column's mean."""
    mean, own = float(row["mean_density"]), row.isel(species=kind)
    return Points(label, row["height"], own["density"] / mean, own["density_error"] / mean, some=True)


def percent(x, ratio, error):
    """Deviation of a ratio from 1."""
    return Points(None, x, 100.0 * (ratio - 1.0), 100.0 * error, some=True)


def test_profiles_and_the_equation_of_state_of_a_column():
    ds = varied(with_source(columns()))
    density, ratio, temperature, state, deviation, *panels = draw(gravity.barometric, ds).axes
    dilute, dense, sample, large = (ds.isel(point=n) for n in range(4))
    shows(density, "", "density", profile(dilute, 0, "dilute"), profile(dense, 0, "dense"))
    theory = (ideal(dilute, 0), dense["hydrostatic"].isel(species=0))
    ratios, temperatures = [], []
    for row, expected, label in zip((dilute, dense), theory, ("ideal gas", "hydrostatics"), strict=True):
        follows(line(density, label), row["height"], expected / float(row["mean_density"]))
        own = row.isel(species=0)
        ratios.append(percent(row["height"], own["density"] / expected, own["density_error"] / expected))
        temperatures.append(percent(row["height"], row["temperature_ratio"], row["temperature_ratio_error"]))
    shows(ratio, "", "rho_", *ratios)
    shows(temperature, "height", "T(z)", *temperatures)
    eta, z = dense["packing_fraction"], dense["compressibility"]
    shows(state, "", "P/", Points("weight above", eta, z, dense["compressibility_error"]))
    obeys(line(state, "virial"), lambda x: compressibility_factor(x, 2))
    shows(
        deviation, "packing fraction", "ref",
        percent(eta, dense["pressure_ratio"], dense["pressure_ratio_error"]),
    )  # fmt: skip
    names = ((large, "later"), (sample, "source's sample"))
    ratios = [(row["height"], row["temperature_ratio"], row["temperature_ratio_error"]) for row, _ in names]
    shows(panels[0], "", "density", *(profile(row, 0, name) for row, name in names))
    for drawn, (row, _) in zip(lines(panels[0]), names, strict=True):
        follows(drawn, row["height"], row["hydrostatic"].isel(species=0) / float(row["mean_density"]))
    shows(panels[1], "source's column", "T(z)", *(percent(*values) for values in ratios))


def test_without_the_source_s_columns_there_are_no_panels_for_them():
    assert len(draw(gravity.barometric, varied(columns())).axes) == 5
    assert len(draw(gravity.separation, varied(columns(2))).axes) == 4


def test_densities_of_two_species_and_their_ratio():
    ds = varied(with_source(columns(2)))
    *densities, ratio, residual, shares = draw(gravity.separation, ds).axes
    for n, axis in enumerate(densities):
        row = ds.isel(point=n)
        shows(axis, "", "density", profile(row, 0, "light"), profile(row, 1, "heavy"))
        mean = float(row["mean_density"])
        for kind in (0, 1):
            expected = row["hydrostatic"].isel(species=kind) if n else ideal(row, kind)
            follows(lines(axis)[kind * (1 + n)], row["height"], expected / mean)
    follows(line(densities[1], "heavy if ideal"), row["height"], ideal(row, 1) / mean)
    logarithms, residuals = [], []
    for n, name in enumerate(("dilute", "dense")):
        row = ds.isel(point=n)
        logarithms.append(Points(name, row["height"], row["log_ratio"], row["log_ratio_error"]))
        sigmas = (row["log_ratio"] - row["log_ratio_expected"]) / row["log_ratio_error"]
        residuals.append(Points(None, row["height"], sigmas))
        follows(lines(ratio)[n], row["height"], row["log_ratio_expected"])
    shows(ratio, "", "ln", *logarithms)
    shows(residual, "height", "residual", *residuals)
    own, top = ds.isel(point=2), float(ds["top"][2])
    middles = (np.arange(10) + 0.5) * top / 10
    shows(
        shares,
        "source's mixture",
        "share",
        Points("the same, here", middles, own["share"], own["share_error"]),
    )
    light, heavy = own["hydrostatic"]
    follows(line(shares, "equilibrium"), own["height"], light / (light + heavy))
    [steps] = (patch for patch in shares.patches if patch.get_label() == "source's run")
    assert list(steps.get_data().values) == ds.attrs["source_shares"]


def test_heat_capacities_from_slopes_and_from_fluctuations():
    ds = varied(capacities())
    capacity, deviation = draw(gravity.heat_capacity, ds).axes
    values, deviations = [], []
    for name, x, label in (("slope", "x", "dE/dT"), ("fluctuation", "run_x", "fluctuations")):
        expected = ds[f"{name}_expected"]
        values.append(Points(label, ds[x], ds[name], ds[f"{name}_error"]))
        ratio, error = ds[name] / expected, ds[f"{name}_error"] / expected
        deviations.append(Points(None, ds[x], 100.0 * (ratio - 1.0), 100.0 * error))
    shows(capacity, "", "heat capacity", *values)
    shows(deviation, "height of the box", "exact", *deviations)
    obeys(line(capacity, "canonical"), lambda x: ideal_heat_capacity(x, 2))
