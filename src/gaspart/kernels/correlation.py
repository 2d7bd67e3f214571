"""Products of the present velocities and positions with earlier ones, summed over particles and axes.

Earlier samples lie side by side, so that the inner loop runs over them: each lag has a sum of its own, over
particles in their order. It is compiled to vector instructions, and the bits do not depend on their width.
"""

from gaspart.kernels.compile.policy import kernel


@kernel
def add_velocity_products(earlier, now, used, sums):
    """Add v(0).v(t) to the row of sums (1, S) for the first `used` of S earlier samples.

    earlier: (1, K, S), velocities; now: (1, K), the present ones.
    """
    for k in range(now.shape[1]):
        v = now[0, k]
        for s in range(used):
            sums[0, s] += earlier[0, k, s] * v


@kernel
def add_displacement_products(earlier, now, used, sums):
    """The same with |r(t) - r(0)|^2 and (r(t) - r(0)).(v(t) + v(0)) in two more rows of sums (3, S).

    earlier: (2, K, S), velocities and positions; now: (2, K), the present ones.
    """
    for k in range(now.shape[1]):
        v, r = now[0, k], now[1, k]
        for s in range(used):
            u, moved = earlier[0, k, s], r - earlier[1, k, s]
            sums[0, s] += u * v
            sums[1, s] += moved * moved
            sums[2, s] += moved * (u + v)
