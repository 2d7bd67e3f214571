import numpy as np
from reproduction.families.drawn import Points, column, draw, shows, varied
from reproduction.families.film.data import slits

from gaspart.reproduction.families.film.figure import thin_film


def test_density_contact_theorem_and_solvation_pressure_are_drawn():
    ds = varied(slits(), "place")
    profile, contact, solvation = draw(thin_film, ds).axes
    wall = Points([0.0], ds["pressure"][-1:], ds["pressure_error"][-1:])
    shows(profile, column(ds, "place", "density"), wall)
    width = ds["width"].values.copy()
    width[-1] = 5.8  # the widest at the end of the axis
    ratio = ds["contact"] / ds["pressure"]
    error = np.hypot(ds["contact_error"], ds["truncation"]) / ds["contact"]
    error = np.hypot(error, ds["pressure_error"] / ds["pressure"])
    shows(contact, Points(width, 100.0 * (ratio - 1.0), 100.0 * ratio * error))
    excess = ds["at_bulk"] - ds.attrs["bulk_pressure"]
    shows(solvation, Points(width, excess, ds["at_bulk_error"]))
