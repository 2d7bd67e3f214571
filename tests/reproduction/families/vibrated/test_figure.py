from reproduction.families.drawn import Points, column, draw, shows
from reproduction.families.vibrated.data import beds

from gaspart.reproduction.families.vibrated import figure
from gaspart.reproduction.families.vibrated.claims import expected_temperature, small_parameter
from gaspart.reproduction.table import Table


def test_temperatures_and_profiles():
    ds = beds(limit=1.02)
    upper, lower = draw(figure.vibrated_bed, ds).axes
    temperatures, profiles = [], []
    for kind in range(2):
        own = ds.isel(bed=(ds["sine"] == kind).values)
        unit = expected_temperature(Table(own, "bed"))
        measured = own["temperature"] / unit, own["temperature_error"] / unit
        temperatures.append(Points(small_parameter(Table(own, "bed")), *measured))
        profiles.append(column(own.isel(bed=0), "place", "density"))  # the most elastic one
    shows(upper, *temperatures)
    shows(lower, *profiles)
