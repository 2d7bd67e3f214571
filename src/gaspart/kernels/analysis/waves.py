"""Sums of exp(i k.r) over particles, for wave vectors of a periodic container.

The exponential is a product of factors, one per axis. The factors are powers of exp(2 pi i x / L). Each power
is a product of two factors with half its exponent, so rounding errors grow only as the logarithm of the
exponent. Particles are processed in blocks, whose factors fit into the processor cache. There are `LANES`
partial sums, each over every 16th particle, which are added in a fixed order. So the compiler can use
vectors, and the bits do not depend on the width of the vectors.
"""

import numpy as np

from gaspart.kernels.compile.policy import allocating_kernel, inner_helper

BLOCK, LANES = 64, 16
CONJUGATE = -1
"""Second index of a row that is the complex conjugate of the row with its first index."""


@inner_helper
def tabulate_factors(cosines, sines, first, products, real, imaginary):
    """Compute the rows of factors of a block; beyond the last particle they are 0. Row 0 is 1, the next rows
    are the factors of the axes, and the other rows are `products`.
    """
    here = min(BLOCK, cosines.shape[1] - first)
    base = 1 + len(cosines)
    for n in range(BLOCK):
        real[0, n], imaginary[0, n] = 1.0 if n < here else 0.0, 0.0
    for k in range(len(cosines)):
        real[1 + k, here:] = 0.0
        imaginary[1 + k, here:] = 0.0
        for n in range(here):
            real[1 + k, n], imaginary[1 + k, n] = cosines[k, first + n], sines[k, first + n]
    for row in range(len(products)):
        a, b = products[row]
        if b == CONJUGATE:
            for n in range(BLOCK):
                real[base + row, n], imaginary[base + row, n] = real[a, n], -imaginary[a, n]
        else:
            for n in range(BLOCK):
                real[base + row, n] = real[a, n] * real[b, n] - imaginary[a, n] * imaginary[b, n]
                imaginary[base + row, n] = real[a, n] * imaginary[b, n] + imaginary[a, n] * real[b, n]


@inner_helper
def sum_lanes(lanes):
    """Return the sum of all lanes."""
    for n in range(8):
        lanes[n] += lanes[n + 8]
    return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]))


@inner_helper
def sum_products_of_two(real, imaginary, rows, lanes):
    """Store the sums of products of two factors in two rows of lanes."""
    a, b, c, d = real[rows[0]], imaginary[rows[0]], real[rows[1]], imaginary[rows[1]]
    for n in range(LANES):
        u = v = 0.0
        for part in range(BLOCK // LANES):
            m = n + part * LANES
            u += a[m] * c[m] - b[m] * d[m]
            v += a[m] * d[m] + b[m] * c[m]
        lanes[0, n], lanes[1, n] = u, v


@inner_helper
def sum_products_of_three(real, imaginary, rows, lanes):
    """Store the sums of products of three factors in two rows of lanes."""
    a, b, c, d = real[rows[0]], imaginary[rows[0]], real[rows[1]], imaginary[rows[1]]
    e, f = real[rows[2]], imaginary[rows[2]]
    for n in range(LANES):
        u = v = 0.0
        for part in range(BLOCK // LANES):
            m = n + part * LANES
            p, q = a[m] * c[m] - b[m] * d[m], a[m] * d[m] + b[m] * c[m]
            u += p * e[m] - q * f[m]
            v += p * f[m] + q * e[m]
        lanes[0, n], lanes[1, n] = u, v


@allocating_kernel
def sum_waves(cosines, sines, products, waves, sums):
    """Add sum exp(i k.r) over N particles to the sums of real and imaginary parts."""
    rows = 1 + len(cosines) + len(products)
    real, imaginary, lanes = np.empty((rows, BLOCK)), np.empty((rows, BLOCK)), np.empty((2, LANES))
    for first in range(0, cosines.shape[1], BLOCK):
        tabulate_factors(cosines, sines, first, products, real, imaginary)
        for m in range(len(waves)):
            if waves.shape[1] == 2:
                sum_products_of_two(real, imaginary, waves[m], lanes)
            else:
                sum_products_of_three(real, imaginary, waves[m], lanes)
            sums[0, m] += sum_lanes(lanes[0])
            sums[1, m] += sum_lanes(lanes[1])
