"""The ray tracer against geometry that is worked out pixel by pixel."""

import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view

from gaspart.kernels.drawing.ray_tracing import render_once, sky
from gaspart.rendering.camera import camera_for, edges_of
from gaspart.rendering.tracer import EDGE, FLOOR, NOTHING, SPHERE, cells, trace

LENGTHS = np.array([10.0, 8.0, 6.0])
SIZE = (120, 90)


def picture(positions, radii):
    """Camera, image and what stands in each pixel, of grey spheres."""
    camera = camera_for(LENGTHS, *SIZE)
    colours = np.full((len(radii), 3), 0.5)
    return camera, *trace(np.array(positions), np.array(radii), colours, LENGTHS, camera, SIZE)


def rays(camera):
    """(H, W, 3) directions through the middles of the pixels."""
    across = (2.0 * (np.arange(SIZE[0]) + 0.5) / SIZE[0] - 1.0) * camera.half_width
    along = (1.0 - 2.0 * (np.arange(SIZE[1]) + 0.5) / SIZE[1]) * camera.half_height
    directions = camera.forward + across[:, None] * camera.right + along[:, None, None] * camera.up
    return directions / np.linalg.norm(directions, axis=-1, keepdims=True)


def entries(origins, directions, positions, radii):
    """(..., N) distances at which rays enter spheres, or infinity: every pair, by the textbook formula."""
    to = np.asarray(positions) - origins[..., None, :]
    b = np.einsum("...nk,...k->...n", to, directions)
    root = b**2 - (to**2).sum(axis=-1) + np.asarray(radii) ** 2
    t = b - np.sqrt(np.maximum(root, 0.0))
    return np.where((root >= 0.0) & (t > 1e-6), t, np.inf)


def expected(camera, positions, radii):
    """What each pixel shows, edges apart: floor, spheres in front of one another, shadows."""
    directions = rays(camera)
    origins = np.broadcast_to(camera.eye, directions.shape)
    t = entries(origins, directions, positions, radii)
    nearest, which = t.min(axis=-1), t.argmin(axis=-1)
    down = np.where(directions[..., 2] < 0.0, -camera.eye[2] / directions[..., 2], np.inf)
    ground = camera.eye + np.where(np.isfinite(down), down, 0.0)[..., None] * directions
    floor = (
        np.isfinite(down) & (ground[..., :2] >= 0.0).all(axis=-1) & (ground[..., :2] <= LENGTHS[:2]).all(-1)
    )
    floor &= down < nearest
    shown = np.where(np.isfinite(nearest), SPHERE + 2 * which, NOTHING)
    shown[floor] = FLOOR
    place = (
        camera.eye
        + np.where(floor, down, np.where(np.isfinite(nearest), nearest, 0.0))[..., None] * directions
    )
    normal = np.where(floor[..., None], [0.0, 0.0, 1.0], place - np.asarray(positions)[which])
    lit = (normal @ camera.light > 0.0) & (shown > NOTHING)
    lamp = np.broadcast_to(camera.light, directions.shape)
    return shown + (lit & np.isfinite(entries(place, lamp, positions, radii).min(axis=-1)))


@pytest.mark.parametrize("count", [1, 2, 60])
def test_silhouettes_occlusion_and_shadows_are_where_geometry_says(count):
    rng = np.random.default_rng(count)
    positions = rng.uniform(0.5, LENGTHS - 0.5, (count, 3))
    radii = rng.uniform(0.05, 0.9, count)
    camera, _, shown = picture(positions, radii)
    wanted = expected(camera, positions, radii)
    where = shown != EDGE
    differing = (shown != wanted) & where
    assert where.mean() > 0.8
    assert differing.sum() <= 2  # a pixel at the very rim may round the other way
    assert {SPHERE, FLOOR, FLOOR + 1, NOTHING} <= set(np.unique(shown))


def test_a_shadow_is_darker_than_the_same_place_without_it():
    middle = LENGTHS / 2
    above = middle + 2.0 * camera_for(LENGTHS, *SIZE).light
    _, with_it, shown = picture([middle, above], [0.8, 0.8])
    _, without, _ = picture([middle], [0.8])
    dark = shown == SPHERE + 1
    assert dark.sum() > 20
    assert (with_it[dark] < without[dark]).all()
    assert with_it.min() >= 0.0 and with_it.max() <= 1.0
    assert with_it[0, 0].tolist() == [1.0, 1.0, 1.0]


def test_a_sphere_takes_its_part_of_the_sky():
    """r^2 / d^2 of the light of an even sky if it stands straight above (exact), faded with its distance."""
    spheres = np.array([[5.0, 4.0, 3.0, 1.0]])
    grid = cells(spheres, LENGTHS)
    side = grid[1]
    up = (0.0, 0.0, 1.0)
    faded = (1.0 - 2.0 / side) ** 2
    assert sky((5.0, 4.0, 0.0), up, spheres, grid) == pytest.approx(1.0 - faded / 9.0)
    assert sky((5.0, 4.0, 0.0), (0.0, 0.0, -1.0), spheres, grid) == 1.0
    many = np.repeat(spheres, 30, axis=0)  # as one, thirty times: no cell counts a sphere twice
    many[1:, 0] = np.linspace(0.3, 9.7, 29)
    many[1:, 3] = 0.01
    grid = cells(many, LENGTHS)
    alone = sky((5.0, 4.0, 1.8), up, many, (*grid[:3], *one_list(grid, 0), grid[5]))
    gap = (1.0 - (1.2 - 1.0) / grid[1]) ** 2
    assert alone == pytest.approx(1.0 - gap / 1.44)


def one_list(grid, i):
    """The lists of a grid with sphere i alone."""
    first, listed = grid[3:5]
    kept = listed == i
    return np.concatenate([[0], np.cumsum(kept)])[first], listed[kept]


def test_the_container_fills_the_picture():
    for lengths in ([1.0, 1.0, 1.0], [30.0, 2.0, 2.0], [1.0, 1.0, 9.0]):
        for size in ((1000, 750), (300, 900)):
            camera = camera_for(np.array(lengths), *size)
            corners = (
                np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * lengths - camera.eye
            )
            depth = corners @ camera.forward
            across = np.abs(corners @ camera.right / depth) / camera.half_width
            along = np.abs(corners @ camera.up / depth) / camera.half_height
            widest = max(across.max(), along.max())
            assert 0.9 < widest < 1.0
            assert camera.near == pytest.approx(depth.min(), rel=0.05)


def test_divided_pixels_have_the_mean_of_sixteen_rays():
    """Against a picture of four times the size, edges of the container apart."""
    rng = np.random.default_rng(3)
    positions, radii = rng.uniform(0.5, LENGTHS - 0.5, (80, 3)), rng.uniform(0.2, 0.8, 80)
    colours, camera = rng.uniform(0.1, 1.0, (80, 3)), camera_for(LENGTHS, *SIZE)
    image, codes = trace(positions, radii, colours, LENGTHS, camera, SIZE)

    def trace_once(times):
        """The mean colours of the pixels with times x times rays through each."""
        width, height = SIZE
        fine = np.empty((times * height, times * width, 3))
        view = np.array([camera.eye, camera.forward, camera.right, camera.up, camera.light])
        scales = (camera.half_width, camera.half_height, camera.near, camera.far)
        spheres = np.column_stack([positions, radii])
        scene, grid = (spheres, colours**2.2, edges_of(LENGTHS), LENGTHS), cells(spheres, LENGTHS)
        shape = fine.shape[:2]
        render_once(fine, np.empty(shape, dtype=np.int64), np.empty(shape), view, scales, scene, grid)
        means = np.minimum(fine, 1.0).reshape(height, times, width, times, 3).mean(axis=(1, 3))
        return means ** (1.0 / 2.2)

    means = trace_once(4)

    around = sliding_window_view(np.pad(codes, 2, mode="edge"), (5, 5))
    inside = ~(around == EDGE).any(axis=(2, 3))
    divided = inside & (around[..., 1:4, 1:4] != codes[..., None, None]).any(axis=(2, 3))
    apart = np.abs(image - means).max(axis=2)
    assert inside.mean() > 0.5 and divided.sum() > 1000
    assert np.median(apart[divided]) < 2e-3 and np.quantile(apart[divided], 0.99) < 0.05
    undivided = np.abs(trace_once(1) - means).max(axis=2)
    assert (undivided[divided] ** 2).mean() > 30.0 * (apart[divided] ** 2).mean()
