"""The data sets of the scaling figures: each is measured once."""

import pytest
from reproduction.families.scaling.data import points, settings

from gaspart.reproduction.families.scaling import measure


@pytest.fixture(scope="session")
def dataset(tmp_path_factory):
    """Returns a copy of a figure's data set."""
    made = {}

    def of(figure):
        if figure not in made:
            folder = tmp_path_factory.mktemp(figure)
            made[figure] = getattr(measure, figure)(points(figure, folder), settings(figure))
        return made[figure].copy(deep=True)

    return of
