"""Claims about the structure of the fluid, and its chemical potential."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim
from gaspart.reproduction.families.shared import PARTICLES, SOURCE_C
from gaspart.reproduction.table import Row, Table

AGREE = 0.005
"""Largest standard error at which an agreement to 1 % is conclusive."""
DENSE = 0.25
"""Packing fraction above which numbers of the Percus-Yevick theory of spheres are measurably wrong.

Compressibility and contact value differ by 4 % and more, which exceeds the errors of the measurement.
"""
DENSEST = 0.4
"""Packing fraction above which the Percus-Yevick curves differ everywhere, relative to their noise."""


def structure(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on compressibility and contact value, and on Verlet-Weis curves.

    Both numbers are measured by independent methods.
    """
    claims = []
    for fluid in Table(ds, "point"):
        claims += [_compressibility(fluid), *_contact(fluid)]
        if _spheres_from(DENSEST, fluid):
            claims += _curves(fluid)
    return claims


def _where(fluid: Row) -> str:
    return f"{PARTICLES[fluid.dimension]}, packing fraction {fluid.packing_fraction:.3g}"


def _spheres_from(packing_fraction: float, fluid: Row) -> bool:
    """Return True if a fluid consists of spheres, with at least this packing fraction."""
    return bool(fluid.dimension == 3 and fluid.packing_fraction >= packing_fraction)


def _compressibility(fluid: Row) -> Claim:
    eta = fluid.packing_fraction
    yevick = (1.0 - eta) ** 4 / (1.0 + 2.0 * eta) ** 2
    return Claim(
        claim=f"S(0) over the compressibility of the measured equation of state, {_where(fluid)}",
        measured=fluid.s0_ratio,
        expected=1.0,
        required=AGREE,
        source="S(0) = k T dρ/dP, the fluctuation of the number (exact)",
        alternative=yevick / fluid.state_s0.value if _spheres_from(DENSE, fluid) else None,
        fails_if="wave vectors that the container does not admit, too few independent frames, an "
        "extrapolation that does not hold, or a wrong pressure",
    )


def _contact(fluid: Row) -> list[Claim]:
    eta, where = fluid.packing_fraction, _where(fluid)
    yevick = (1.0 + 0.5 * eta) / (1.0 - eta) ** 2
    return [
        Claim(
            claim=f"contact value from g(r) over that from Z, {where}",
            measured=fluid.g_ratio,
            expected=1.0,
            required=AGREE,
            source="the virial theorem: Z = 1 + 2^(d-1) η g(σ) (exact)",
            alternative=yevick / fluid.contact_z.value if _spheres_from(DENSE, fluid) else None,
            fails_if="frames that are no sample of what the collisions see, pairs that are counted wrongly, "
            "or a wrong pressure",
        ),
        Claim(
            claim=f"contact value from the collision rate over that from Z, {where}",
            measured=fluid.rate_ratio,
            expected=1.0,
            required=AGREE,
            source="velocities are independent of positions: the rate is g(σ) times that of independent "
            "particles (exact, for N particles of a fixed energy)",
            follows=True,
            fails_if="collisions missed, or relative speeds at contact that are not Maxwellian",
        ),
    ]


def _curves(fluid: Row) -> list[Claim]:
    return [
        Claim.at_most(
            claim=f"distance of {name} from Verlet and Weis's over that from Percus and Yevick's, "
            f"{_where(fluid)}",
            measured=fluid[key],
            bound=0.5,
            required=0.1,
            source="[Verlet 1972] corrects the contact value and the phase of [Percus 1958]; one half is "
            "chosen here",
            fails_if="a wrong phase or height of the maxima, measured or computed",
        )
        for name, key in (("g(r)", "g_gain"), ("S(k)", "s_gain"))
    ]


def chemical_potential(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on insertion compared with Gibbs-Duhem, its failures, and Q."""
    fluids = Table(ds, "point")
    claims = [_works(fluid) if fluid.works else _fails(fluid, fluids.enough) for fluid in fluids]
    for dimension in (3, 2):
        own = fluids[(fluids.dimension == dimension) & (fluids.works == 1)]
        if len(own) > 1:
            claims.append(
                Claim.joint(
                    claim=f"chemical potential by insertion of {PARTICLES[dimension]}, all packing fractions",
                    deviations=(own.inserted - own.reference).deviation,
                    source="the integral of the reference equation of state ([Kolafa 2004], [Clisby 2006])",
                    fails_if="a bias too small for one point is common to many, or the error bars are wrong",
                )
            )
            claims += [_partition(own[-1])] if np.isfinite(own.ln_q_ratio.value[-1]) else []
    return claims


def _works(fluid: Row) -> Claim:
    return Claim(
        claim=f"chemical potential by insertion over that of the equation of state, {_where(fluid)}",
        measured=fluid.ratio,
        expected=1.0,
        required=0.01,
        source="[Widom 1963] and the equation of Gibbs and Duhem, with the measured Z (both exact)",
        fails_if="places that are not uniform, overlaps that are missed, correlated frames that are "
        "counted as independent, or a wrong pressure",
    )


def _fails(fluid: Row, enough: int) -> Claim:
    return Claim(
        claim=f"chance of an insertion over that of the equation of state, {_where(fluid)}",
        measured=fluid.probability / fluid.expected.value,
        expected=1.0,
        required=1.0,
        source=f"as where it works; the chemical potential is {fluid.reference.value:.3g} k T",
        no_verdict=f"only {fluid.hit_frames} of {fluid.frames} frames have a free place ({enough} are asked "
        "for): their number is no Gaussian one",
        fails_if="places that are not uniform, or overlaps that are missed",
    )


def _partition(fluid: Row) -> Claim:
    return Claim(
        claim=f"ln Q / N by insertion over that of the measured equation of state, {_where(fluid)}",
        measured=fluid.ln_q_ratio,
        expected=1.0,
        required=0.01,
        source=f"{SOURCE_C}, Eq. 46: both are the free energy beyond an ideal gas's (exact)",
        follows=True,
        fails_if="insertion or the pressure is wrong at a lower density",
    )
