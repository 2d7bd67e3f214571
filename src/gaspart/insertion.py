"""Random sequential insertion: the kernel that tries places one after another."""

import numpy as np

from gaspart.coordinates import box_coordinate
from gaspart.kernel import allocating_kernel, helper
from gaspart.plates import gap_to_plate
from gaspart.segments import square_from_segment


@helper
def overlap(trial, body, other, positions, radii, lengths, periodic):
    """Whether a body at the place `trial` (d,) would overlap another that is placed already."""
    square = 0.0
    for k in range(len(lengths)):
        gap = abs(trial[k] - positions[other, k])
        if periodic[k]:
            gap = min(gap, lengths[k] - gap)
        square += gap * gap
    reach = radii[body] + radii[other]
    return square < reach * reach


@allocating_kernel
def place(
    draws,
    positions,
    radii,
    start,
    stop,
    lower,
    upper,
    lengths,
    periodic,
    per_side,
    widths,
    neighbour,
    head,
    following,
    strides,
    failures,
    patience,
    attempts_at,
    walls,
    beside,
):
    """Try the `draws` (M, d) in [0, 1) as places for bodies start, start + 1, ... stop - 1, in that order.

    A place is free if no body already there is nearer than the sum of the radii. lower, upper: (d,) corners
    of the region for the centres. `failures` counts the current body's failed attempts across calls; at
    `patience` the search gives up. attempts_at: (N,) number of failed attempts of each placed body.
    walls: (M, 5) or (M, 11) interior walls to keep clear of (see `segments`, `plates`), or None. beside: (K,)
    bodies that may reach further than the boxes tell.

    Returns (next body to place, failures so far, draws used).
    """
    dimension = len(lengths)
    trial = np.empty(dimension)
    at = np.zeros(3, np.int64)
    body = start
    used = 0
    while used < draws.shape[0] and body < stop and failures < patience:
        for k in range(dimension):
            trial[k] = lower[k] + draws[used, k] * (upper[k] - lower[k])
            at[k] = box_coordinate(trial[k], widths[k], per_side[k])
        used += 1
        free = True
        if walls is not None:
            for m in range(len(walls)):
                if dimension == 2:
                    square = square_from_segment(walls, m, trial[0], trial[1])
                else:
                    x, y, z = gap_to_plate(walls, m, trial[0], trial[1], trial[2])
                    square = x * x + y * y + z * z
                free = free and square >= radii[body] * radii[body]
        for other in beside:
            free = free and not overlap(trial, body, other, positions, radii, lengths, periodic)
        for dz in range(3):
            z = neighbour[2, at[2], dz]
            for dy in range(3):
                y = neighbour[1, at[1], dy]
                for dx in range(3):
                    x = neighbour[0, at[0], dx]
                    if not free or x < 0 or y < 0 or z < 0:
                        continue
                    other = head[x + y + z]
                    while other >= 0:
                        if overlap(trial, body, other, positions, radii, lengths, periodic):
                            free = False
                            break
                        other = following[other]
        if not free:
            failures += 1
            continue
        box = 0
        for k in range(dimension):
            positions[body, k] = trial[k]
            box += at[k] * strides[k]
        following[body] = head[box]
        head[box] = body
        attempts_at[body] = failures
        failures = 0
        body += 1
    return body, failures, used
