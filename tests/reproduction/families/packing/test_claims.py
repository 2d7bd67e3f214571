"""The claims of the densest packings, right and wrong."""

import pytest
from reproduction.families.packing.data import packings

from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.packing.claims import densest_fill


def verdicts(**changes):
    return judge(densest_fill(packings(**changes)))


def test_packings_as_they_should_be_agree():
    assert verdicts() == ["agrees", "agrees", "no verdict"]


@pytest.mark.parametrize(("changes", "wrong"), [({"inserted": 0.42}, 0), ({"compressed": 0.55}, 1)])
def test_packings_that_are_not_disagree(changes, wrong):
    assert verdicts(**changes)[wrong] == "disagrees"
