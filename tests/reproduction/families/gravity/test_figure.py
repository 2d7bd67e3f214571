import numpy as np
from reproduction.families.drawn import Points, column, draw, shows, varied
from reproduction.families.gravity.data import capacities, columns, with_source

from gaspart.reproduction.families.gravity import figure as gravity
from gaspart.theory.gravity import ideal_profile


def ideal(row, kind):
    """(B,) density of an ideal gas with the mean density, the mass and the temperature of the column's."""
    own = row.isel(species=kind)
    top = float(own["top"])
    weight = float(own["mass"] * own["strength"] / own["temperature"])
    return float(own["density"].mean()) * top * ideal_profile(own["height"].values, top, weight)


def profile(row, kind):
    """Density of a species over the column's mean."""
    mean, own = float(row["mean_density"]), row.isel(species=kind)
    return Points(row["height"], own["density"] / mean, own["density_error"] / mean, some=True)


def percent(x, ratio, error):
    """Deviation of a ratio from 1."""
    return Points(x, 100.0 * (ratio - 1.0), 100.0 * error, some=True)


def test_profiles_and_the_equation_of_state_of_a_column():
    ds = varied(with_source(columns()))
    density, ratio, temperature, state, deviation, *panels = draw(gravity.barometric, ds).axes
    dilute, dense, sample, large = (ds.isel(point=n) for n in range(4))
    shows(density, profile(dilute, 0), profile(dense, 0))
    theory = (ideal(dilute, 0), dense["hydrostatic"].isel(species=0))
    ratios, temperatures = [], []
    for row, expected in zip((dilute, dense), theory, strict=True):
        own = row.isel(species=0)
        ratios.append(percent(row["height"], own["density"] / expected, own["density_error"] / expected))
        temperatures.append(percent(row["height"], row["temperature_ratio"], row["temperature_ratio_error"]))
    shows(ratio, *ratios)
    shows(temperature, *temperatures)
    eta, z = dense["packing_fraction"], dense["compressibility"]
    shows(state, Points(eta, z, dense["compressibility_error"]))
    shows(deviation, percent(eta, dense["pressure_ratio"], dense["pressure_ratio_error"]))
    own = (large, sample)
    shows(panels[0], *(profile(row, 0) for row in own))
    ratios = [(row["height"], row["temperature_ratio"], row["temperature_ratio_error"]) for row in own]
    shows(panels[1], *(percent(*values) for values in ratios))
    assert len(draw(gravity.barometric, varied(columns())).axes) == 5  # without the source's columns


def test_densities_of_two_species_and_their_ratio():
    ds = varied(with_source(columns(2)))
    *densities, ratio, residual, shares = draw(gravity.separation, ds).axes
    for n, axis in enumerate(densities):
        row = ds.isel(point=n)
        shows(axis, profile(row, 0), profile(row, 1))
    logarithms, residuals = [], []
    for row in (ds.isel(point=n) for n in range(2)):
        logarithms.append(Points(row["height"], row["log_ratio"], row["log_ratio_error"]))
        sigmas = (row["log_ratio"] - row["log_ratio_expected"]) / row["log_ratio_error"]
        residuals.append(Points(row["height"], sigmas))
    shows(ratio, *logarithms)
    shows(residual, *residuals)
    own, top = ds.isel(point=2), float(ds["top"][2])
    middles = (np.arange(10) + 0.5) * top / 10
    shows(shares, Points(middles, own["share"], own["share_error"]))
    [steps] = (patch for patch in shares.patches if patch.get_label() == "source's run")
    assert list(steps.get_data().values) == ds.attrs["source_shares"]
    assert len(draw(gravity.separation, varied(columns(2))).axes) == 4  # without the source's columns


def test_heat_capacities_from_slopes_and_from_fluctuations():
    ds = varied(capacities())
    capacity, deviation = draw(gravity.heat_capacity, ds).axes
    values, deviations = [], []
    for name, x in (("slope", "x"), ("fluctuation", "run_x")):
        expected = ds[f"{name}_expected"]
        values.append(column(ds, x, name))
        ratio, error = ds[name] / expected, ds[f"{name}_error"] / expected
        deviations.append(Points(ds[x], 100.0 * (ratio - 1.0), 100.0 * error))
    shows(capacity, *values)
    shows(deviation, *deviations)
