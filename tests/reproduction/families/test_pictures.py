""""""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from reproduction.families.drawn import draw

from gaspart.reproduction.claims import judge
from gaspart.reproduction.families.pictures import claims as claims_of_pictures
from gaspart.reproduction.families.pictures import figure as draw_pictures
from gaspart.reproduction.families.pictures import measure
from gaspart.reproduction.points.point import Point

CUBE = np.full(3, 10.0)


@pytest.mark.parametrize(
    ("second", "periodic", "expected"),
    [
        ([2.9, 2.0, 2.0], False, 1),
        ([3.0 - 1e-6, 2.0, 2.0], False, 0),  # rounding
        ([3.01, 2.0, 2.0], False, 0),
        ([2.0, 2.0, 9.9], False, 0),
        ([2.0, 2.0, 9.9], True, 0),
    ],
)
def test_overlapping_pairs(second, periodic, expected):
    places = np.array([[2.0, 2.0, 2.0], second, [7.0, 7.0, 7.0]])
    assert measure.overlapping(places, np.full(3, 0.5), CUBE, (periodic,) * 3) == expected


def test_overlaps_across_a_face_and_with_a_large_particle():
    places = np.array([[0.2, 5.0, 5.0], [9.6, 5.0, 5.0], [5.0, 5.0, 5.0], [5.0, 7.4, 5.0], [5.0, 8.1, 5.0]])
    radii = np.array([0.5, 0.5, 2.0, 0.5, 0.5])
    assert measure.overlapping(places, radii, CUBE, (False,) * 3) == 2
    assert measure.overlapping(places, radii, CUBE, (True, False, False)) == 3


def test_a_scene_is_counted_and_kept_for_drawing(tmp_path):
    from gaspart import run

    settings = {
        "scene": "config/scenes/brownian.yaml",
        "scene.species.0.count": 200,
        "duration": 2.0,
        "samples": 1,
    }
    point = Point("brownian_render", "single", "simulate", settings, str(tmp_path), 1)
    (tmp_path / "brownian_render/single").mkdir(parents=True)
    run(point.scene, point.engine, 1, 2.0, 2.0, point.replica_path(0))
    ds = measure.brownian_render([point], {})
    assert ds.sizes["particle"] == ds.attrs["count"] == 201
    assert float(ds["overlaps"]) == 0.0 and float(ds["resolved"]) == 0.0
    assert ds["radius"].values.tolist() == [10.0] + [0.5] * 200
    assert float(ds["mean_speed"]) == pytest.approx(1.0, abs=0.1)


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
    claims = claims_of_pictures.gas_render(scene(**changes))
    found = {
        claim.claim for claim, verdict in zip(claims, judge(claims), strict=True) if verdict == "disagrees"
    }
    assert found == disagreeing


def test_the_large_particle():
    assert set(judge(claims_of_pictures.brownian_render(scene(overlaps=0.0)))) == {"agrees"}
    assert judge(claims_of_pictures.brownian_render(scene(overlaps=1.0))).count("disagrees") == 1
    lost = scene(overlaps=0.0).isel(particle=slice(7999))
    assert judge(claims_of_pictures.brownian_render(lost)).count("disagrees") == 2


@pytest.fixture
def dataset():
    rng = np.random.default_rng(1)
    return xr.Dataset(
        {
            "position": (("particle", "axis"), rng.uniform(1, 9, (20, 3))),
            "radius": ("particle", rng.uniform(0.4, 0.6, 20)),
            "species": ("particle", np.arange(20) // 19),
            "speed": ("particle", rng.uniform(0, 2, 20)),
            "length": ("axis", np.array([10.0, 11.0, 12.0])),
        }
    )


@pytest.mark.parametrize("function", [draw_pictures.gas_render, draw_pictures.brownian_render])
def test_the_picture_is_drawn_with_a_pixel_for_each_dot(dataset, function):
    figure = draw(function, dataset)
    image = figure.axes[0].images[0].get_array()
    assert image.shape == (1260, 1680, 3)
    saturated = np.ptp(image.astype(int), axis=-1) > 60
    assert 0.002 < saturated.mean() < 0.5


@pytest.mark.parametrize(
    ("function", "colour"), [(draw_pictures.gas_render, "speed"), (draw_pictures.brownian_render, "species")]
)
def test_the_particles_of_the_data_set_are_drawn(monkeypatch, dataset, function, colour):
    drawn, coloured = [], []

    def picture(particles, size, colours):
        drawn.append(particles)
        return np.zeros((*size[::-1], 3), dtype=np.uint8)

    monkeypatch.setattr(draw_pictures, "picture", picture)
    monkeypatch.setattr(draw_pictures, "colours_of", lambda particles, by: coloured.append(by))
    figure = draw(function, dataset)
    particles = drawn[-1]
    assert coloured == [colour]
    columns = {"positions": "position", "radii": "radius", "species": "species", "speeds": "speed"}
    for name, column in {**columns, "lengths": "length"}.items():
        assert np.array_equal(getattr(particles, name), dataset[column])
    fastest = draw_pictures.FASTEST * float(np.sqrt((dataset["speed"] ** 2).mean()))
    scales = [scale.get_xlim() for scale in figure.axes[1:]]
    assert scales == ([pytest.approx((0.0, fastest))] if colour == "speed" else [])
