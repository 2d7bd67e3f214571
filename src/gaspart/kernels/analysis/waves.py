"""Sums of exp(i k.r) over particles, at wave vectors of a periodic container.

The exponential is a product of one factor per axis. Factors are powers of exp(2 pi i x / L), each made from
two factors of half its exponent, so that rounding grows as the logarithm of the exponent. Particles are
processed in blocks, whose factors stay in the processor's cache. Each of `LANES` sums has every 16th
particle, and they are added in one order: the compiler makes vectors, and the bits do not depend on their
width.
"""

import numpy as np

from gaspart.kernels.compile.policy import allocating_kernel, inner_helper

BLOCK, LANES = 64, 16
CONJUGATE = -1
"""Second factor of a row that is the complex conjugate of its first one."""


@inner_helper
def tabulate_factors(cosines, sines, first, products, real, imaginary):
    """Fill the rows of a block's factors; all are 0 beyond the last particle.

    Row 0 is 1, the next rows are the factors of the axes, and the others are `products`.

    Parameters
    ----------
    cosines, sines : (d, N), of 2 pi x / L along each axis
    first : first particle of the block
    products : (R, 2), rows whose product is each further row, or a row and `CONJUGATE`
    real, imaginary : (rows, BLOCK), filled with the factors
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
    """Return the sum of all lanes.

    Parameters
    ----------
    lanes : (LANES,), which are overwritten
    """
    for n in range(8):
        lanes[n] += lanes[n + 8]
    return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]))


@inner_helper
def sum_products_of_two(real, imaginary, rows, lanes):
    """Fill two rows of lanes with the sums of the products of two factors.

    Parameters
    ----------
    real, imaginary : (rows, BLOCK), factors
    rows : (2,), rows of the factors
    lanes : (2, LANES), filled with the real and the imaginary parts
    """
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
    """Fill two rows of lanes with the sums of the products of three factors.

    Parameters
    ----------
    real, imaginary : (rows, BLOCK), factors
    rows : (3,), rows of the factors
    lanes : (2, LANES), filled with the real and the imaginary parts
    """
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
    """Add sum exp(i k.r) over N particles to sums of real and imaginary parts.

    Parameters
    ----------
    cosines, sines : (d, N), of 2 pi x / L along each axis
    products : (R, 2), rows whose product is each further row of factors, or a row and `CONJUGATE`
    waves : (M, d), row of each axis for each wave vector
    sums : (2, M), real and imaginary parts
    """
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
