import pytest
from reproduction.families.drawn import Points, column, draw, follows, line, lines, obeys, shows, varied
from reproduction.families.heat.data import gases, metals

from gaspart.reproduction.families.heat import figure as heat
from gaspart.theory.heat import conducting_slab


def test_fluxes_and_profiles_of_a_gas():
    ds = varied(gases(), "knudsen", "number")
    flux, share, start, warm, deviation, dense = draw(heat.heat_conduction_gas, ds).axes
    row = ds.isel(point=0)
    all_components = Points("all components", [row["number"]], [1e3 * row["flux"]], [1e3 * row["flux_error"]])
    nothing = Points("normal only", [], [], [])
    shows(flux, "number density", "heat flux", all_components, nothing)
    full, number, fourier = (float(row[name]) for name in ("full", "number", "fourier"))
    obeys(line(flux, "free flight"), lambda n: 1e3 * full * n / number)
    obeys(line(flux, "guide"), lambda n: 1e3 / (number / (n * full) + 1.0 / fourier))
    hot, cold, length = (float(row[name]) for name in ("hot", "cold", "length"))
    n, fluxes = line(flux, "with jumps").get_data()
    assert fluxes[-1] == pytest.approx(
        1e3 * conducting_slab(length, n[-1], hot, cold).flux
    )  # each takes a second
    infinity = {dimension: 20.0 * 1.15 ** (dimension - 2.5) for dimension in (2, 3)}
    groups = (([0, 1], "all, spheres"), ([2], "normal, spheres"), ([3], "all, discs"), ([4], "normal, discs"))
    shares = []
    for points, label in groups:
        own = ds.isel(point=points)
        x = [
            float(k) if k < 100.0 else infinity[int(d)]
            for k, d in zip(own["knudsen"], own["dimension"], strict=True)
        ]
        shares.append(Points(label, x, own["flux"] / own["full"], own["flux_error"] / own["full"]))
    shows(share, "Knudsen", "flux", *shares)
    shows(start, "time", "T_", Points("0.03", row["approach_time"], row["approach"], row["approach_error"]))
    follows(line(start, "heat equation"), row["approach_time"], row["expected_approach"])
    position = row["position"] / length
    temperature, expected = row["temperature"], row["slab_temperature"]
    shows(warm, "", "temperature", Points("0.03", position, temperature, row["temperature_error"]))
    follows(line(warm, "Fourier"), position, expected)
    off = Points(
        None, position, 100.0 * (temperature / expected - 1.0), 100.0 * row["temperature_error"] / expected,
        some=True,
    )  # fmt: skip
    shows(deviation, "", "T_", off)
    assert deviation.containers[0].lines[0].get_xdata().size == int(row["used"].sum())
    density = Points(None, position, row["density"] / number, row["density_error"] / number)
    shows(dense, "position", "density", density)
    follows(lines(dense)[0], position, row["slab_density"] / number)


def test_a_noisy_density_is_not_drawn():
    ds = gases()
    ds["density_error"] = 0.05 * ds["density"]
    dense = draw(heat.heat_conduction_gas, ds).axes[-1]
    assert not dense.containers and lines(dense)


def test_temperatures_and_energies_of_a_metal():
    ds = varied(metals(), "hot", "cold")
    profiles, energy, deviation = draw(heat.heat_conduction_metal, ds).axes
    row = ds.isel(point=0)
    shows(
        profiles, "position", "electrons", column(row, "electrons", "position", "electrons"),
        column(row, "modes", "position", "modes"),
    )  # fmt: skip
    still = ds.isel(point=[1, 2])
    warm, level, error = still["hot"], still["energy_ratio"], still["energy_ratio_error"]
    shows(energy, "", "energy", Points("electrons and modes", warm, level * warm, error * warm))
    obeys(line(energy, "kT"), lambda x: x)
    obeys(line(energy, "frozen"), lambda x: float(ds["electrons_part"][0]) * x)
    modes, bars = still["mode_ratio"], still["mode_ratio_error"]
    shows(
        deviation, "temperature", "deviation", Points(None, warm, 100.0 * (level - 1.0), 100.0 * error),
        Points(None, 1.02 * warm, 100.0 * (modes - 1.0), 100.0 * bars),
    )  # fmt: skip
