import numpy as np
from reproduction.families.drawn import Points, column, draw, follows, line, shows, varied
from reproduction.families.film.data import slits

from gaspart.reproduction.families.film.figure import thin_film


def test_density_contact_theorem_and_solvation_pressure_are_drawn():
    ds = varied(slits(), "place")
    profile, contact, solvation = draw(thin_film, ds).axes
    widest = ds.isel(width=[-1])
    shows(
        profile, "contact", "density", column(ds, "measured, $H=12", "place", "density"),
        Points("on the wall", [0.0], widest["pressure"], widest["pressure_error"]),
    )  # fmt: skip
    follows(line(profile, "White Bear"), ds["place"], ds["functional"])
    width = ds["width"].values.copy()
    width[-1] = 5.8  # the widest at the end of the axis
    ratio = ds["contact"] / ds["pressure"]
    parts = (
        np.hypot(ds["contact_error"], ds["truncation"]) / ds["contact"],
        ds["pressure_error"] / ds["pressure"],
    )
    shows(contact, "", "rho(0)", Points(None, width, 100.0 * (ratio - 1.0), 100.0 * ratio * np.hypot(*parts)))
    excess = ds["at_bulk"] - ds.attrs["bulk_pressure"]
    shows(solvation, "width", "bulk", Points("measured", width, excess, ds["at_bulk_error"]))
    curve = ds["curve"] - ds.attrs["functional_bulk_pressure"]
    follows(line(solvation, "White Bear"), ds["theory_width"], curve)
    assert solvation.texts[0].get_text() == "12"
