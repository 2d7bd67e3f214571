"""Products of present velocities and positions with earlier ones, summed over particles and axes.

Earlier samples are adjacent in memory, so the inner loop runs over them. Each lag has its own sum over the
particles, in their order. The loop is compiled to vector instructions. The bits do not depend on the width of
the vectors.
"""

from math import sqrt

from gaspart.kernels.compile.policy import inner_helper, kernel


@kernel
def add_velocity_products(earlier, now, used, sums):
    """Add v(0).v(t) to the row of sums (1, S) for the first `used` earlier samples. `earlier`: (1, K, S),
    velocities of S earlier samples. `now`: (1, K), present velocities.
    """
    for k in range(now.shape[1]):
        v = now[0, k]
        for s in range(used):
            sums[0, s] += earlier[0, k, s] * v


@kernel
def add_displacement_products(earlier, now, used, sums):
    """Add v(0).v(t) and the products with displacements to three rows of sums (3, S). The products with
    displacements are |r(t) - r(0)|^2 and (r(t) - r(0)).(v(t) + v(0)). `earlier`: (2, K, S), velocities and
    positions of S earlier samples. `now`: (2, K), present velocities and positions.
    """
    for k in range(now.shape[1]):
        v, r = now[0, k], now[1, k]
        for s in range(used):
            u, moved = earlier[0, k, s], r - earlier[1, k, s]
            sums[0, s] += u * v
            sums[1, s] += moved * moved
            sums[2, s] += moved * (u + v)


@inner_helper
def shear_components(sums, first, d, components, filled):
    """Compute the shear components of the symmetric part of a tensor. There are (d - 1)(d + 2) / 2 such
    components; in an isotropic fluid they fluctuate equally. The tensor begins at index `first` of the sums,
    and the components at index `filled`. Returns the index after the last component.
    """
    for a in range(d):
        for b in range(a + 1, d):
            components[filled] = 0.5 * (sums[first + d * a + b] + sums[first + d * b + a])
            filled += 1
    x, y = sums[first], sums[first + d + 1]
    components[filled] = 0.5 * (x - y)
    filled += 1
    if d == 3:
        components[filled] = (x + y - 2.0 * sums[first + 8]) / (2.0 * sqrt(3.0))
        filled += 1
    return filled


@kernel
def flux_components(sums, dimension, components):
    """Compute the components of the fluxes whose correlations are accumulated. `sums`: (2 d^2 + d,), the
    stress tensor, its collisional part, and the heat flux. `components`: shear components of the stress
    tensor, components of its antisymmetric part, shear components of the collisional part, 1/d of the trace
    of the stress tensor, and the heat flux.
    """
    d = dimension
    filled = shear_components(sums, 0, d, components, 0)
    for a in range(d):
        for b in range(a + 1, d):
            components[filled] = 0.5 * (sums[d * a + b] - sums[d * b + a])
            filled += 1
    filled = shear_components(sums, d * d, d, components, filled)
    trace = 0.0
    for a in range(d):
        trace += sums[d * a + a]
        components[filled + 1 + a] = sums[2 * d * d + a]
    components[filled] = trace / d


@kernel
def add_flux_products(earlier, now, groups, used, sums):
    """Add the products of fluxes for the first `used` earlier samples. The products J(0) J(t), (G(t) -
    G(0))^2, [J(0) + J(t)] / 2 and G(t) - G(0) are added to sums (groups, 4, S). `earlier`: (2, K, S), fluxes
    J and their integrals G of S earlier samples. `now`: (2, K), present fluxes and integrals. `groups`: (K,),
    group number of each component.
    """
    for k in range(now.shape[1]):
        flux, integral, group = now[0, k], now[1, k], groups[k]
        for s in range(used):
            moved = integral - earlier[1, k, s]
            sums[group, 0, s] += earlier[0, k, s] * flux
            sums[group, 1, s] += moved * moved
            sums[group, 2, s] += 0.5 * (earlier[0, k, s] + flux)
            sums[group, 3, s] += moved
