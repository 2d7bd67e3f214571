from reproduction.families.drawn import Points, column, draw, shows
from reproduction.families.driven_gas.data import driven

from gaspart.reproduction.families.driven_gas import figure


def test_temperatures_and_cumulants():
    ds = driven(1.02, 0.003)
    upper, lower = draw(figure.driven_gas, ds).axes
    temperatures, cumulants = [], []
    for dimension in (2, 3):
        own = ds.isel(gas=(ds["dimension"] == dimension).values)
        unit = own["temperature"] / 1.02
        ratio = own["temperature"] / unit, own["temperature_error"] / unit
        temperatures.append(Points(own["restitution"], *ratio))
        cumulants.append(column(own, "restitution", "cumulant"))
    shows(upper, *temperatures)
    shows(lower, *cumulants)
