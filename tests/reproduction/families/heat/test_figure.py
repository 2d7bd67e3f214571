from reproduction.families.drawn import Points, column, draw, lines, shows, varied
from reproduction.families.heat.data import gases, metals

from gaspart.reproduction.families.heat import figure as heat


def test_fluxes_and_profiles_of_a_gas():
    ds = varied(gases(), "knudsen", "number")
    flux, share, start, warm, deviation, dense = draw(heat.heat_conduction_gas, ds).axes
    row = ds.isel(point=0)
    whole = Points([row["number"]], [1e3 * row["flux"]], [1e3 * row["flux_error"]])
    shows(flux, whole, Points([], [], []))
    number, length = float(row["number"]), float(row["length"])
    shares = []
    for points in ([0, 1], [2], [3], [4]):
        own = ds.isel(point=points)
        infinity = 20.0 * 1.15 ** (own["dimension"] - 2.5)
        x = own["knudsen"].where(own["knudsen"] < 100.0, infinity)
        shares.append(Points(x, own["flux"] / own["full"], own["flux_error"] / own["full"]))
    shows(share, *shares)
    shows(start, Points(row["approach_time"], row["approach"], row["approach_error"]))
    position = row["position"] / length
    temperature, expected = row["temperature"], row["slab_temperature"]
    shows(warm, Points(position, temperature, row["temperature_error"]))
    percent = 100.0 * (temperature / expected - 1.0), 100.0 * row["temperature_error"] / expected
    shows(deviation, Points(position, *percent, some=True))
    assert deviation.containers[0].lines[0].get_xdata().size == int(row["used"].sum())
    shows(dense, Points(position, row["density"] / number, row["density_error"] / number))


def test_a_noisy_density_is_not_drawn():
    ds = gases()
    ds["density_error"] = 0.05 * ds["density"]
    dense = draw(heat.heat_conduction_gas, ds).axes[-1]
    assert not dense.containers and lines(dense)


def test_temperatures_and_energies_of_a_metal():
    ds = varied(metals(), "hot", "cold")
    profiles, energy, deviation = draw(heat.heat_conduction_metal, ds).axes
    row = ds.isel(point=0)
    shows(profiles, column(row, "position", "electrons"), column(row, "position", "modes"))
    still = ds.isel(point=[1, 2])
    warm, level, error = still["hot"], still["energy_ratio"], still["energy_ratio_error"]
    shows(energy, Points(warm, level * warm, error * warm))
    modes, bars = still["mode_ratio"], still["mode_ratio_error"]
    shows(
        deviation,
        Points(warm, 100.0 * (level - 1.0), 100.0 * error),
        Points(1.02 * warm, 100.0 * (modes - 1.0), 100.0 * bars),
    )
