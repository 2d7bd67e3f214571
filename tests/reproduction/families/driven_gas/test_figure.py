from reproduction.families.drawn import Points, draw, lines, obeys, shows
from reproduction.families.driven_gas.data import driven

from gaspart import theory
from gaspart.reproduction.families.driven_gas import figure


def test_temperatures_and_cumulants():
    ds = driven(1.02, 0.003)
    upper, lower = draw(figure.driven_gas, ds).axes
    temperatures, cumulants = [], []
    for dimension, name in ((2, "discs"), (3, "spheres")):
        own = ds.isel(gas=(ds["dimension"] == dimension).values)
        unit = own["temperature"] / 1.02
        e = own["restitution"]
        temperatures.append(Points(name, e, own["temperature"] / unit, own["temperature_error"] / unit))
        cumulants.append(Points(name, e, own["cumulant"], own["cumulant_error"]))
    shows(upper, "", "energy balance", *temperatures)
    shows(lower, "restitution", "fourth cumulant", *cumulants)
    obeys(lines(lower)[0], lambda e: theory.finite_size_cumulant(theory.driven_cumulant(e, 2), 500, 2))
    obeys(lines(lower)[1], lambda e: theory.finite_size_cumulant(theory.fourth_cumulant(e, 2), 500, 2))
    obeys(lines(lower)[2], lambda e: theory.finite_size_cumulant(theory.driven_cumulant(e, 3), 500, 3))
