import numpy as np
from reproduction.families.drawn import Points, draw, lines, obeys, shows
from reproduction.families.vibrated.data import beds

from gaspart.reproduction.families.vibrated import figure
from gaspart.reproduction.families.vibrated.claims import expected_temperature, small_parameter
from gaspart.reproduction.table import Table


def test_temperatures_and_profiles():
    ds = beds(limit=1.02)
    upper, lower = draw(figure.vibrated_bed, ds).axes
    temperatures, profiles = [], []
    for kind, name in enumerate(("sawtooth", "sine")):
        own = ds.isel(bed=(ds["sine"] == kind).values)
        unit = expected_temperature(Table(own, "bed"))
        measured = own["temperature"] / unit, own["temperature_error"] / unit
        temperatures.append(Points(name, small_parameter(Table(own, "bed")), *measured))
        bed = own.isel(bed=0)  # the most elastic one
        profiles.append(Points(name, bed["place"], bed["density"], bed["density_error"]))
    shows(upper, "epsilon", "energy balance", *temperatures)
    shows(lower, "height", "density", *profiles)
    obeys(lines(upper)[0], lambda x: 1.02 - 0.5 * x + 0.2 * x**2)
    obeys(lines(lower)[0], lambda z: np.exp(-z))
