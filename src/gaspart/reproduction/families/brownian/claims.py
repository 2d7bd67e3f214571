"""Claims about Brownian motion of a large particle."""

from __future__ import annotations

import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.table import Row, Table

LANGEVIN = "the Langevin equation with the friction of a dilute gas ([Chapman 1970])"
BOLTZMANN = "the linear Boltzmann equation, direct simulation (gaspart.theory.boltzmann)"
RELAXING = f"{BOLTZMANN}, in a gas that relaxes from equal speeds (gaspart.theory.boltzmann)"
FAILS_IF = {
    "equipartition": "a particle with another energy than the gas gives it",
    "friction": "a wrong momentum exchange",
    "diffusion": "memory",
}
STATISTICAL = "the statistical error of the direct simulation"


def _name(row: Row) -> str:
    """Return the name of the particle in a row."""
    gas = ", gas of equal speeds" if row.equal_speeds else ""
    steps = "time-stepped, " if row.stepped else ""
    return f"{steps}mass {row.mass / row.gas_mass:g} times a gas particle's{gas}"


def _source(row: Row) -> str:
    """Return the source of the expected values of a row."""
    if not row.is_light:
        return LANGEVIN
    return RELAXING if row.equal_speeds else BOLTZMANN


def brownian_paths(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the distances from the start at the end of the paths."""
    return [
        Claim.chi_square(
            claim=f"ends of {row.replicas} paths over their variance from rest, {_name(row)}",
            chi_square=row.end_chi_square,
            degrees_of_freedom=row.end_freedom,
            source=_source(row),
            fails_if="paths that spread too far or too little, or are cut off by the walls",
        )
        for row in Table(ds, "point")
    ]


def brownian_msd(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on equipartition, friction and diffusion of every point.

    Some claims state that the mean free path suffices for the theory. If both engines simulated a scene,
    further claims compare their results.
    """
    points = Table(ds, "point")
    claims = [claim for row in points for claim in _coefficients(row)]
    for steps in points[points.stepped]:
        for events in points[~points.stepped]:
            if all(steps[name] == events[name] for name in ("equal_speeds", "mass", "friction")):
                claims += _both_engines(steps, events)
    return claims


def _both_engines(steps: Row, events: Row) -> list[Claim]:
    """Return the claims on ratios of the time-stepped to the event-driven engine.

    The runs are independent.
    """
    return [
        Claim(
            claim=f"{text} by time steps over that by events, {_name(events)}",
            measured=steps[key] / events[key],
            expected=1.0,
            required=required,
            follows=True,
            source="both engines solve the same equations of motion",
            fails_if="contacts that time steps miss, count twice, or resolve along a wrong normal",
        )
        for text, key, required in (
            ("energy of the large particle", "equipartition", 0.04),
            ("friction rate", "measured_friction", 0.04),
            ("diffusion coefficient", "measured_diffusion", 0.08),
        )
    ]


def _alternative(row: Row, key: str) -> float | None:
    """Return the value of a competing theory.

    If the gas has equal speeds, the competing theory assumes that it is in equilibrium. If the gas is in
    equilibrium, the competing theory uses the radius of the large particle instead of the contact distance.
    """
    if row.equal_speeds:
        return 1.0 if key == "equipartition" else float(row[key])
    bare = (row.radius / row.contact) ** 2
    factor = {"friction": bare, "diffusion": 1.0 / bare}.get(key)
    return factor and factor * float(row[f"expected_{key}"].value)


def _coefficients(row: Row) -> list[Claim]:
    name, claims = _name(row), []
    for text, key, measured, required in (
        ("equipartition M<V^2>/3kT", "equipartition", "equipartition", 0.03),
        ("friction rate", "friction", "measured_friction", 0.03),
        ("diffusion coefficient", "diffusion", "measured_diffusion", 0.05),
    ):
        expected = row[f"expected_{key}"]
        claims.append(
            Claim(
                claim=f"{text}, {name}",
                measured=row[measured],
                expected=expected,
                required=required * expected.value,
                source=_source(row),
                allowance_source=STATISTICAL,
                alternative=_alternative(row, key),
                follows=key == "diffusion",  # nearly energy divided by friction
                fails_if=FAILS_IF[key],
            )
        )
    claims.append(
        Claim.at_least(
            claim=f"mean free path over the particle's radius, {name}",
            kind="identity",
            measured=Estimate(row.mean_free_path / row.radius),
            bound=10.0,
            required=1.0,
            source="the friction is that of a gas whose particles do not collide near the large one",
            fails_if="a gas so dense that its own flow around the particle matters",
        )
    )
    return claims
