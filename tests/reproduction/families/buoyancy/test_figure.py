import numpy as np
from reproduction.families.buoyancy.data import measurement, with_source
from reproduction.families.drawn import Points, column, draw, follows, line, lines, obeys, shows, varied

from gaspart.reproduction.families.buoyancy.figure import buoyancy
from gaspart.theory.buoyancy import displaced_area


def test_forces_radii_and_heights_are_drawn_with_theory():
    ds = varied(measurement())
    force, radius, height = draw(buoyancy, ds).axes
    eta = "fixed_packing_fraction"
    shows(
        force, "", "mass displaced", column(ds, "from the force", eta, "fixed_force"),
        column(ds, "small discs missing", eta, "fixed_missing"),
    )  # fmt: skip
    shows(
        radius, "packing fraction", "R_\\mathrm{eff}", column(ds, None, eta, "fixed_force_radius"),
        column(ds, None, eta, "fixed_count_radius"),
    )  # fmt: skip
    ratio = ds.attrs["size_ratio"]
    own, margin, theory = lines(radius)
    obeys(own, lambda x: 0.0 * x)
    obeys(margin, np.ones_like)
    obeys(theory, lambda x: np.sqrt(displaced_area(x, ratio)) - ratio)
    shows(
        height, "mass", "height", column(ds, "mean height", "free_mass", "free_height"),
        Points("theory", ds["free_mass"], ds["free_expected"]),
    )  # fmt: skip
    displaced, *fluctuations = lines(height)
    follows(displaced, ds["displaced"], ds["height"])
    for n, one in enumerate(fluctuations):
        mass, middle, spread = (float(ds[f"free_{name}"][n]) for name in ("mass", "height", "spread"))
        follows(one, [mass, mass], [middle - spread, middle + spread])
    assert len(fluctuations) == ds.sizes["free"]


def test_the_source_s_discs_have_a_panel_if_there_are_any():
    ds = varied(with_source(measurement()))
    *others, own = draw(buoyancy, ds).axes
    assert len(others) == 3
    relative = ds["source_density"] / ds.attrs["source_density"]
    shows(
        own, "density of the disc", "height",
        Points("source's discs", relative, ds["source_height"], ds["source_height_error"]),
    )  # fmt: skip
    follows(line(own, "theory"), relative, ds["source_expected"])
