"""Compiled part of the ray tracer (see `rendering.tracer`): rays, shadows and skylight."""

from __future__ import annotations

import math

from gaspart.kernels.compile.policy import (
    helper,
    inner_helper,
    inner_kernel,
    kernel,
)

SUBRAYS = 4
_ORDER = (0, 3, 12, 15, 1, 2, 4, 5, 6, 7, 8, 9, 10, 11, 13, 14)
"""Order of the rays through a pixel, row by row; the corners are first."""
NOTHING, FLOOR, EDGE, SPHERE = 0, 2, 4, 6
"""Codes of the visible object in a pixel. Sphere i is SPHERE + 2 i; 1 is added for points in shadow."""

_AMBIENT, _LAMP, _GLOSS = 0.55, 0.75, 0.18
_HAZE = 0.22  # fraction of its colour that the far end of the container loses
_FLOOR_LIGHT, _EDGE_LIGHT = 0.72, 0.16
_EDGE_PIXELS = 0.8  # half of the width of the container's edges


@kernel
def list_spheres(lowest, highest, numbers, cursors, listed):
    """Count the spheres of each cell in `cursors`, or fill the lists of the cells. If `listed` is not empty,
    the index of each sphere is written to the next free entry of its cells.
    """
    for i in range(len(lowest)):
        for x in range(lowest[i, 0], highest[i, 0] + 1):
            for y in range(lowest[i, 1], highest[i, 1] + 1):
                for z in range(lowest[i, 2], highest[i, 2] + 1):
                    c = (x * numbers[1] + y) * numbers[2] + z
                    if len(listed):
                        listed[cursors[c]] = i
                    cursors[c] += 1


@helper
def _cell(x, low, side, number):
    return min(max(int((x - low) / side), 0), number - 1)


@inner_helper
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inner_helper
def _along(o, d, t):
    return o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]


@inner_kernel
def _hit(o, d, sphere):
    """Return the distance at which a ray from outside enters a sphere, or infinity."""
    to = (sphere[0] - o[0], sphere[1] - o[1], sphere[2] - o[2])
    b = _dot(to, d)
    miss = _along(to, d, -b)
    inside = sphere[3] * sphere[3] - _dot(miss, miss)
    if inside < 0.0:
        return math.inf
    t = b - math.sqrt(inside)
    return t if t > 1e-6 * sphere[3] else math.inf


@inner_kernel
def _nearest(o, d, spheres, grid, any_will_do):
    """Return distance and index of the first sphere on a ray. Without a hit they are infinity and -1."""
    low, side, numbers, first, listed, _ = grid
    enter, leave = 0.0, math.inf
    for k in range(3):
        if d[k] == 0.0:
            if not low[k] <= o[k] <= low[k] + side * numbers[k]:
                return math.inf, -1
        else:
            a, b = (low[k] - o[k]) / d[k], (low[k] + side * numbers[k] - o[k]) / d[k]
            enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
    if enter > leave:
        return math.inf, -1
    at = _along(o, d, enter)
    x = _cell(at[0], low[0], side, numbers[0])
    y = _cell(at[1], low[1], side, numbers[1])
    z = _cell(at[2], low[2], side, numbers[2])
    best, index = math.inf, -1
    while 0 <= x < numbers[0] and 0 <= y < numbers[1] and 0 <= z < numbers[2]:
        c = (x * numbers[1] + y) * numbers[2] + z
        for n in range(first[c], first[c + 1]):
            t = _hit(o, d, spheres[listed[n]])
            if t < best:
                best, index = t, listed[n]
                if any_will_do:
                    return best, index
        to_x = (low[0] + (x + (d[0] > 0.0)) * side - o[0]) / d[0] if d[0] != 0.0 else math.inf
        to_y = (low[1] + (y + (d[1] > 0.0)) * side - o[1]) / d[1] if d[1] != 0.0 else math.inf
        to_z = (low[2] + (z + (d[2] > 0.0)) * side - o[2]) / d[2] if d[2] != 0.0 else math.inf
        if best <= min(to_x, to_y, to_z):
            break
        if to_x <= to_y and to_x <= to_z:
            x += 1 if d[0] > 0.0 else -1
        elif to_y <= to_z:
            y += 1 if d[1] > 0.0 else -1
        else:
            z += 1 if d[2] > 0.0 else -1
    return best, index


@kernel
def sky(p, n, spheres, grid):
    """Return the fraction of the sky above a point that is not hidden by near spheres. A sphere of radius r
    hides c / h^2 of the light of a uniform sky if it is completely above the horizon (exact). Its centre is
    at the distance h r, and c is the cosine of its angle to the normal. As the sphere sets, this fraction
    goes to 0. Only spheres closer than the side of a cell count, and their effect fades with distance. Each
    sphere counts once, in the first of the 27 cells that contains it. `p`: point on a surface. `n`: normal of
    the surface.
    """
    low, side, numbers, first, listed, lowest = grid
    free = 1.0
    cx = _cell(p[0], low[0], side, numbers[0])
    cy = _cell(p[1], low[1], side, numbers[1])
    cz = _cell(p[2], low[2], side, numbers[2])
    lx, ly, lz = max(cx - 1, 0), max(cy - 1, 0), max(cz - 1, 0)
    for x in range(lx, min(cx + 2, numbers[0])):
        for y in range(ly, min(cy + 2, numbers[1])):
            for z in range(lz, min(cz + 2, numbers[2])):
                c = (x * numbers[1] + y) * numbers[2] + z
                for m in range(first[c], first[c + 1]):
                    s = spheres[listed[m]]
                    r = s[3]
                    to = (s[0] - p[0], s[1] - p[1], s[2] - p[2])
                    distance = math.sqrt(_dot(to, to))
                    gap = (distance - r) / side
                    rise = _dot(to, n) / r
                    if gap >= 1.0 or rise <= -1.0 or distance <= r * (1.0 + 1e-9):
                        continue
                    own = lowest[listed[m]]
                    if x > max(lx, own[0]) or y > max(ly, own[1]) or z > max(lz, own[2]):
                        continue
                    share = rise if rise > 1.0 else 0.25 * (1.0 + rise) ** 2
                    free *= 1.0 - (1.0 - gap) ** 2 * share * (r / distance) ** 3
    return free


@inner_kernel
def _edge(o, d, edges, thickness):
    """Return the distance of the nearest edge of the container within `thickness` times it of a ray."""
    best = math.inf
    for m in range(len(edges)):
        e = edges[m]
        w, u = (o[0] - e[0], o[1] - e[1], o[2] - e[2]), (e[3], e[4], e[5])
        b = _dot(d, u)
        s = (_dot(u, w) - b * _dot(d, w)) / max(1.0 - b * b, 1e-12)
        s = min(max(s, 0.0), e[6])
        gap = (s * u[0] - w[0], s * u[1] - w[1], s * u[2] - w[2])
        t = _dot(gap, d)
        beside = _dot(gap, gap) - t * t
        if 0.0 < t < best and beside < (thickness * t) ** 2:
            best = t
    return best


@inner_kernel
def _visible(o, d, scene, grid, thickness):
    """Return distance and code (without shadow) of the visible object on a ray."""
    spheres, _, edges, lengths = scene
    t, i = _nearest(o, d, spheres, grid, False)
    code = SPHERE + 2 * i if i >= 0 else NOTHING
    down = -o[2] / d[2] if d[2] < 0.0 else math.inf
    if down < t:
        p = _along(o, d, down)
        if 0.0 <= p[0] <= lengths[0] and 0.0 <= p[1] <= lengths[1]:
            t, code = down, FLOOR
    if thickness > 0.0:
        edge = _edge(o, d, edges, thickness)
        if edge < t * (1.0 + 1e-9):
            t, code = edge, EDGE
    return t, code


@inner_kernel
def _shade(ray, t, code, view, scales, scene, grid, light_around):
    """Return an object's colour on a ray, 1 if in shadow, and its free sky fraction.

    ray : origin and direction of the ray.
    light_around : 1 if the lamp reaches the point, 0 if not, -1 if unknown; and the fraction of the sky that
    is not hidden above the point, -1 if unknown.
    """
    (o, d), (lit, free) = ray, light_around
    if code == NOTHING:
        return 1.0, 1.0, 1.0, 0, 1.0
    depth = t * (d[0] * view[1, 0] + d[1] * view[1, 1] + d[2] * view[1, 2])
    haze = _HAZE * min(max((depth - scales[2]) / (scales[3] - scales[2]), 0.0), 1.0)
    if code == EDGE:
        grey = _EDGE_LIGHT + haze * (1.0 - _EDGE_LIGHT)
        return grey, grey, grey, 0, 1.0
    spheres, colours, _, _ = scene
    light = (view[4, 0], view[4, 1], view[4, 2])
    p = _along(o, d, t)
    n, colour = (0.0, 0.0, 1.0), (_FLOOR_LIGHT, _FLOOR_LIGHT, _FLOOR_LIGHT)
    if code != FLOOR:
        i = (code - SPHERE) // 2
        r = spheres[i, 3]
        n = (p[0] - spheres[i, 0]) / r, (p[1] - spheres[i, 1]) / r, (p[2] - spheres[i, 2]) / r
        colour = colours[i, 0], colours[i, 1], colours[i, 2]
    lamp, gloss, shadow = max(_dot(n, light), 0.0), 0.0, 0
    if lamp > 0.0:
        if lit == 0 or (lit < 0 and _nearest(p, light, spheres, grid, True)[1] >= 0):
            lamp, shadow = 0.0, 1
        elif code != FLOOR:
            half = (light[0] - d[0], light[1] - d[1], light[2] - d[2])
            gloss = _GLOSS * (_dot(n, half) / math.sqrt(_dot(half, half))) ** 40
    if free < 0.0:
        free = sky(p, n, spheres, grid)
    bright = _AMBIENT * (0.75 + 0.25 * n[2]) * free + _LAMP * lamp
    return (
        (bright * colour[0] + gloss) * (1.0 - haze) + haze,
        (bright * colour[1] + gloss) * (1.0 - haze) + haze,
        (bright * colour[2] + gloss) * (1.0 - haze) + haze,
        shadow,
        free,
    )


@inner_helper
def _direction(column, row, image, view, scales):
    """Return the direction of the ray through a point of the picture. `column` and `row`: coordinates in
    pixels from the upper left corner.
    """
    across = (2.0 * column / image.shape[1] - 1.0) * scales[0]
    along = (1.0 - 2.0 * row / image.shape[0]) * scales[1]
    d = (
        view[1, 0] + across * view[2, 0] + along * view[3, 0],
        view[1, 1] + across * view[2, 1] + along * view[3, 1],
        view[1, 2] + across * view[2, 2] + along * view[3, 2],
    )
    norm = math.sqrt(_dot(d, d))
    return d[0] / norm, d[1] / norm, d[2] / norm


@kernel
def render_once(image, codes, skies, view, scales, scene, grid):
    """Trace one ray through the centre of every pixel. `skies` (H, W) is filled with the free sky fractions
    of the objects.
    """
    o, thickness = (view[0, 0], view[0, 1], view[0, 2]), 2.0 * _EDGE_PIXELS * scales[0] / image.shape[1]
    for row in range(codes.shape[0]):
        for column in range(codes.shape[1]):
            d = _direction(column + 0.5, row + 0.5, image, view, scales)
            t, code = _visible(o, d, scene, grid, thickness)
            red, green, blue, shadow, free = _shade((o, d), t, code, view, scales, scene, grid, (-1, -1.0))
            image[row, column, 0], image[row, column, 1], image[row, column, 2] = red, green, blue
            codes[row, column], skies[row, column] = code + shadow, free


@inner_helper
def _light_around(code, row, column, codes, skies):
    """Return light and free sky fraction of an object in the neighbouring pixels. The light is 1 or 0. Both
    values are -1 if they differ between pixels, or if no neighbouring pixel shows the object.
    """
    lit, free = -2, -1.0
    for y in range(max(row - 1, 0), min(row + 2, codes.shape[0])):
        for x in range(max(column - 1, 0), min(column + 2, codes.shape[1])):
            if codes[y, x] - codes[y, x] % 2 == code:
                here = 1 - codes[y, x] % 2
                lit = here if lit in (-2, here) else -1
                if free < 0.0 or (x == column and y == row):
                    free = skies[y, x]
    return max(lit, -1), free


@inner_helper
def _shows(code, row, column, codes):
    """Return True if a neighbouring pixel shows an object."""
    for y in range(max(row - 1, 0), min(row + 2, codes.shape[0])):
        for x in range(max(column - 1, 0), min(column + 2, codes.shape[1])):
            if codes[y, x] == code:
                return True
    return False


@kernel
def refine(image, codes, skies, pixels, view, scales, scene, grid):
    """Trace SUBRAYS x SUBRAYS rays through the `pixels` (M, 2), given by row and column. The light and the
    free sky fraction of an object are taken from the neighbouring pixels if these agree. If the first four
    rays, near the corners, hit the same object as the ray through the centre, no further rays are traced.
    """
    o, thickness = (view[0, 0], view[0, 1], view[0, 2]), 2.0 * _EDGE_PIXELS * scales[0] / image.shape[1]
    for n in range(len(pixels)):
        row, column = pixels[n, 0], pixels[n, 1]
        thick = thickness if _shows(EDGE, row, column, codes) else 0.0
        red, green, blue, traced = 0.0, 0.0, 0.0, 0
        last, around, alike = -1, (-1, -1.0), True
        for k in range(SUBRAYS * SUBRAYS):
            m = _ORDER[k]
            x, y = column + (m % SUBRAYS + 0.5) / SUBRAYS, row + (m // SUBRAYS + 0.5) / SUBRAYS
            d = _direction(x, y, image, view, scales)
            t, code = _visible(o, d, scene, grid, thick)
            if code != last:
                last = code
                around = _light_around(code, row, column, codes, skies)
            seen = _shade((o, d), t, code, view, scales, scene, grid, around)
            red, green, blue = red + min(seen[0], 1.0), green + min(seen[1], 1.0), blue + min(seen[2], 1.0)
            traced += 1
            alike = alike and code + seen[3] == codes[row, column]
            if k == 3 and alike:
                break
        image[row, column, 0] = red / traced
        image[row, column, 1] = green / traced
        image[row, column, 2] = blue / traced


# Discs and lines are drawn into an image according to the fraction of each pixel that they cover.


_LINE = 0.75  # half of the width of lines in pixels


@inner_kernel
def _blend(image, row, column, cover, red, green, blue):
    image[row, column, 0] += cover * (red - image[row, column, 0])
    image[row, column, 1] += cover * (green - image[row, column, 1])
    image[row, column, 2] += cover * (blue - image[row, column, 2])


@kernel
def draw_discs(image, centres, radii, colours):
    """Draw discs into an image (H, W, 3); later discs cover earlier ones."""
    height, width = image.shape[0], image.shape[1]
    for i in range(len(centres)):
        x, y, r = centres[i, 0], centres[i, 1], radii[i]
        for row in range(max(int(y - r - 1.0), 0), min(int(y + r + 2.0), height)):
            for column in range(max(int(x - r - 1.0), 0), min(int(x + r + 2.0), width)):
                cover = r + 0.5 - math.sqrt((column + 0.5 - x) ** 2 + (row + 0.5 - y) ** 2)
                if cover > 0.0:
                    c = colours[i]
                    _blend(image, row, column, min(cover, 1.0), c[0], c[1], c[2])


@kernel
def draw_segments(image, starts, ends, colour):
    """Draw lines between points (M, 2) into an image (H, W, 3)."""
    height, width = image.shape[0], image.shape[1]
    for m in range(len(starts)):
        ax, ay = starts[m, 0], starts[m, 1]
        ux, uy = ends[m, 0] - ax, ends[m, 1] - ay
        square = ux * ux + uy * uy
        low_x, high_x = min(ax, ends[m, 0]) - _LINE - 1.0, max(ax, ends[m, 0]) + _LINE + 2.0
        low_y, high_y = min(ay, ends[m, 1]) - _LINE - 1.0, max(ay, ends[m, 1]) + _LINE + 2.0
        for row in range(max(int(low_y), 0), min(int(high_y), height)):
            for column in range(max(int(low_x), 0), min(int(high_x), width)):
                x, y = column + 0.5 - ax, row + 0.5 - ay
                s = min(max((x * ux + y * uy) / square, 0.0), 1.0) if square > 0.0 else 0.0
                cover = _LINE + 0.5 - math.sqrt((x - s * ux) ** 2 + (y - s * uy) ** 2)
                if cover > 0.0:
                    _blend(image, row, column, min(cover, 1.0), colour[0], colour[1], colour[2])
