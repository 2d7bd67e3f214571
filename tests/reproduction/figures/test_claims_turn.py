"""The claims of each figure: what they are in its small data set, and that each turns if a number moves."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from reproduction.figures.stored_data import FOLDER, judged, parts, stored, stored_claims

from gaspart.reproduction.claims import judge
from gaspart.reproduction.registry import families

CHANGES = {
    "tenfold": lambda values: 10.0 * values + 1.0,
    "a hundredth": lambda values: 0.01 * values,
    "of the other sign": lambda values: -values,
    "scattered": lambda values: values * (1.0 + 9.0 * (np.indices(values.shape).sum(axis=0) % 2)),
    "of another power": lambda values: np.sign(values) * np.abs(values) ** 3 + 1.0,
    "one of them": lambda values: values + 100.0 * (np.arange(values.size) == 0).reshape(values.shape),
}


def state(figure, dataset):
    """The claims of a data set by their texts; none if there is no claim about such numbers."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            return {claim.claim: claim for claim in parts(figure).claims(dataset)}
        except Exception:  # absurd numbers may have no fit, or no root
            return {}


def changed(dataset, name, change):
    """The data set with other values of a variable; None if the variable is no number."""
    variable = dataset.variables[name]
    if variable.dtype.kind not in "iufb":
        return None
    values = CHANGES[change](variable.values.astype(float))
    if variable.dtype.kind != "f":
        values = np.round(values).astype(variable.dtype)
    return dataset.assign({name: (variable.dims, values, variable.attrs)})


def precise(dataset):
    """The data set with uncertainties of a hundredth: those of a small run may hide any number."""
    errors = [name for name in dataset.variables if str(name).endswith("_error")]
    return dataset.assign({name: 0.01 * dataset[name] for name in errors})


def is_wrong(claim):
    """True if the claim, by itself, disagrees, or lies beyond its bounds."""
    (verdict,) = judge([replace(claim, no_verdict="", kind="test")])
    return verdict == "disagrees" or (claim.form == "bound" and claim.deviation_sigma != 0.0)


def has_turned(before, after):
    """True if a claim became right or wrong, or its deviation moved by more than three uncertainties."""
    moved = abs(after.deviation_sigma - before.deviation_sigma)
    return is_wrong(after) != is_wrong(before) or moved > 3.0


def others(dataset):
    """The data sets in which one variable has other values, or one dimension fewer of them."""
    for change in CHANGES:
        for name in map(str, dataset.variables):
            if (other := changed(dataset, name, change)) is not None:
                yield other
    for dim, size in dataset.sizes.items():
        yield dataset.isel({dim: slice(size // 2)})


SLOW = {
    "adsorption",
    "barometric",
    "box_count",
    "brownian_msd",
    "couette",
    "estimators",
    "msd_spheres",
    "time_to_accuracy",
}
STAYING = {
    "sticky rule: power of the gas' density in the coverage of a wall at low coverage (at most 0.2)",
    "mean of these deviations, signed",
    "relaxation time of speeds by the Boltzmann model over that by events, packing fraction 0.1 "
    "(within 0.560801 to 1.4392)",
}
"""Claims that none of these changes turns in the small data: several numbers would have to move together."""
FIGURES = [pytest.param(name, marks=[pytest.mark.thorough] * (name in SLOW)) for name in families()]


@pytest.mark.parametrize("figure", FIGURES)
def test_each_claim_turns_when_a_number_moves(figure):
    left = None
    for dataset in (stored(figure), precise(stored(figure))):
        before = state(figure, dataset)
        if left is None:
            left = {text for text, claim in before.items() if claim.is_finite}
            assert before
        for other in others(dataset):
            if not left:
                return
            after = state(figure, other)
            left -= {text for text in left & after.keys() if has_turned(before[text], after[text])}
    assert left <= STAYING


@pytest.mark.parametrize("figure", families())
def test_the_claims_of_the_stored_data_are_what_they_were(figure):
    """Other code must not change them unnoticed; `stored_data.py` stores what is meant to change."""
    found, before = judged(figure, stored(figure)), stored_claims(figure)
    assert {text: one[-1] for text, one in found.items()} == {text: one[-1] for text, one in before.items()}
    for text, (*numbers, _) in found.items():
        assert numbers == pytest.approx(before[text][:-1], rel=1e-5, abs=1e-9, nan_ok=True), text


def test_each_figure_has_its_data_set():
    assert {path.name.removesuffix(".nc.xz") for path in FOLDER.iterdir()} == set(families())
