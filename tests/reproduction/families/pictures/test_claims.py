import numpy as np
import pytest
import xarray as xr

from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.pictures import claims as pictures


def scene(**changes):
    """What `measure.pictures` gives of the source's gas."""
    values = {"overlaps": 0.0, "resolved": 15.0, "mean_speed": 0.92, "mean_speed_error": 0.003}
    values |= {"mean_square_speed": 1.0} | changes
    return xr.Dataset(
        {
            **values,
            "position": (("particle", "axis"), np.zeros((8000, 3))),
            "radius": ("particle", np.full(8000, values.pop("size", 0.2))),
            "length": ("axis", np.full(3, 60.0)),
        },
        attrs={"count": 8000, "packing_fraction": 8000 * 4 / 3 * np.pi * 0.2**3 / 60.0**3},
    )


@pytest.mark.parametrize(
    ("changes", "disagreeing"),
    [
        ({}, set()),
        ({"overlaps": 15.0}, {"pairs that overlap at the end of a step"}),
        ({"mean_speed": 0.95}, {"mean speed"}),
        ({"size": 0.3}, {"packing fraction of the spheres drawn (within 0.0005 to 0.0015)"}),
    ],
)
def test_the_gas(changes, disagreeing):
    claims = pictures.gas_render(scene(**changes))
    found = {
        claim.claim for claim, verdict in zip(claims, judge(claims), strict=True) if verdict == "disagrees"
    }
    assert found == disagreeing


def test_the_large_particle():
    assert set(judge(pictures.brownian_render(scene(overlaps=0.0)))) == {"agrees"}
    assert judge(pictures.brownian_render(scene(overlaps=1.0))).count("disagrees") == 1
    lost = scene(overlaps=0.0).isel(particle=slice(7999))
    assert judge(pictures.brownian_render(lost)).count("disagrees") == 2
