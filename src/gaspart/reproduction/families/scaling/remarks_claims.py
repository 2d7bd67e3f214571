"""Claims about source A's remarks on the cost of a step."""

from __future__ import annotations

import numpy as np
import xarray as xr

from gaspart.reproduction.claims import Claim, Estimate
from gaspart.reproduction.families.shared.claims import OTHER_MACHINE, SOURCE_A
from gaspart.reproduction.table import Table


def remarks(ds: xr.Dataset) -> list[Claim]:
    """Return the claims on the source's remarks on the cost of a step.

    They are on work and time.
    """
    near = Table(ds, "near")
    visits = near.near_box_visits / near.near_expected_visits
    return [
        Claim.within(
            claim="boxes searched within reach over those expected, the scan's largest deviation",
            measured=Estimate(visits[np.abs(visits - 1.0).argmax()], visits.std(ddof=1)),
            expected=1.0,
            half_width=0.03,
            source="Steiner's formula, gaspart.theory.dsmc, without the walls' 1 %",
            fails_if="boxes within reach are left out, or others are searched",
        ),
        Claim(
            claim="largest difference of the contacts found with and without the boxes out of reach",
            kind="identity",
            measured=Estimate(near.near_missed),
            expected=0.0,
            required=0.0,
            source="a box farther than a contact holds no partner",
            fails_if="a contact is missed",
        ),
        Claim.at_most(
            claim="least time with only the boxes within reach over the least with all neighbouring ones",
            kind="reproduction",
            measured=near.near_least,
            bound=1.0,
            required=0.1,
            source=f"{SOURCE_A}, section 2.3: to search fewer boxes is a possible improvement",
            source_error="a test of the distance to a box costs more than a look into it: most are empty",
            fails_if="leaving out boxes costs more than looking into them",
        ),
        Claim.at_most(
            claim="share of searches that can end in the own box if it is searched first, widest boxes",
            measured=near.own_first,
            bound=0.01,
            required=0.001,
            source="a search ends early only at a contact, which few particles have in a step",
            fails_if="the order of the boxes matters for the cost",
        ),
        Claim.within(
            claim="pairs tested more per particle and step with one huge sphere",
            measured=near.huge_tests,
            expected=1.0,
            half_width=0.01,
            source=f"{SOURCE_A}, section 4.2: each particle is tested against it",
            fails_if="it is kept in the boxes, which would have to be as wide as it is",
        ),
        Claim.at_most(
            claim="time per step with one huge sphere among 10 000 over that without",
            kind="reproduction",
            measured=near.huge_ratio,
            bound=1.05,
            required=0.05,
            source=f"{SOURCE_A}, section 4.2: a negligible effect",
            source_error=OTHER_MACHINE,
            fails_if="a further test per particle costs more than a twentieth of a step",
        ),
    ]
