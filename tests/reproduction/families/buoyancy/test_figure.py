from reproduction.families.buoyancy.data import measurement, with_source
from reproduction.families.drawn import Points, column, draw, shows, varied

from gaspart.reproduction.families.buoyancy.figure import buoyancy


def test_forces_radii_and_heights_are_drawn():
    ds = varied(with_source(measurement()))
    force, radius, height, own = draw(buoyancy, ds).axes
    eta = "fixed_packing_fraction"
    shows(force, column(ds, eta, "fixed_force"), column(ds, eta, "fixed_missing"))
    shows(radius, column(ds, eta, "fixed_force_radius"), column(ds, eta, "fixed_count_radius"))
    shows(height, column(ds, "free_mass", "free_height"), Points(ds["free_mass"], ds["free_expected"]))
    relative = ds["source_density"] / ds.attrs["source_density"]
    shows(own, Points(relative, ds["source_height"], ds["source_height_error"]))
    assert len(draw(buoyancy, measurement()).axes) == 3  # a source without discs of its own
