r"""Long-time tails of discs' viscosity and conductivity: pairs of hydrodynamic modes in a periodic container.

Of long waves the stress is m rho u_x u_y, and the heat flux, less the enthalpy that the momentum carries,
rho T s u + p u, with the velocity u, the entropy s of a particle and the pressure p relative to their means
(k_B = 1). So their correlations are those of pairs of modes of the wave vectors k and -k: shear with the
kinematic viscosity nu, heat with D_T = lambda / (rho c_p), and sound with the speed c and the attenuation
Gamma (`modes.sound_attenuation`). With T_k = exp(-nu k^2 t), S_k = exp(-Gamma k^2 t / 2) cos(c k t) and
H_k = exp(-D_T k^2 t), the mean over the directions of k gives

.. math:: \frac{d\eta}{dt} = \frac{k_BT}{V} \sum_{k \ne 0} \left[ \frac{T_k^2 + S_k^2}{4}
          + \frac{T_k S_k}{2} \right] ,

.. math:: \frac{d\lambda}{dt} = \frac{1}{2V} \sum_{k \ne 0} \left[ \frac{k_BT c_p}{m} H_k (T_k + S_k)
          + c^2 (e^{-\Gamma k^2 t} + T_k S_k) \right] ,

of an infinite fluid the tails (32 pi t)^-1 (1/nu + 1/Gamma) k_B T, and (8 pi t)^-1 [k_B T c_p / (m (nu +
D_T)) + c^2 / Gamma]. The method is that of Ernst, Hauge and van Leeuwen, Phys. Rev. A 4, 2055 (1971), and J.
Stat. Phys. 15, 7 (1976); the amplitudes were derived again and not compared with the papers (tested against
the linearised equations of the fluid). That of c^2 without a cosine is energy which travels with the sound.
Transport coefficients are Enskog's, and terms of the next order in 1/t are neglected. Everything is in
diameters, masses and k_B T.
"""

import math

from gaspart.errors import SceneError
from gaspart.theory._arguments import Numbers, Values, checked
from gaspart.theory.enskog import enskog_conductivity, enskog_viscosity
from gaspart.theory.geometry import number_density
from gaspart.theory.modes import heat_capacities, sound_attenuation, sum_of_modes
from gaspart.theory.state import speed_of_sound


@checked
def transport_modes(time: Numbers, packing_fraction: float, count: int, quantity: str) -> Values:
    """Discs: Green and Kubo's integral until `time`, but for a constant, of `count` of them in a periodic
    square; quantity: "viscosity" (mass / time) or "conductivity" (1 / time).

    The sums over k of the module, integrated. What the fluxes do before modes describe them is unknown, so
    only differences have a meaning. time: positive, after many collisions of a particle, before or after
    sound has crossed the container. Raises SceneError for another quantity.
    """
    inverse = math.sqrt(float(number_density(packing_fraction, 2)) / count)
    return inverse**2 * sum_of_modes(time, _pairs(packing_fraction, quantity), 2, inverse, integrated=True)


@checked
def transport_uniform_mode(packing_fraction: float, count: int, quantity: str) -> float:
    """Discs: the term k = 0, which fixed sums of momentum and energy take off the flux's correlation, as it
    enters the derivative of the coefficient with respect to time: rho / N k_B T, or rho / N (c_p + c^2).

    Until sound has crossed a container of N discs its integral differs from that of an infinite fluid by this
    times t. Arguments and errors as of `transport_modes`.
    """
    weights = [weight for weight, _, _ in _pairs(packing_fraction, quantity)]
    return float(number_density(packing_fraction, 2)) / count * sum(weights)


@checked
def transport_logarithmic_slope(packing_fraction: float, quantity: str) -> float:
    """Discs: how much the integral of an infinite fluid grows while t grows by a factor e.

    (1/nu + 1/Gamma) / (32 pi) of the viscosity, [c_p / (nu + D_T) + c^2 / Gamma] / (8 pi) of the
    conductivity. Arguments and errors as of `transport_modes`.
    """
    still = [weight / width for weight, width, speed in _pairs(packing_fraction, quantity) if speed == 0.0]
    return sum(still) / (4.0 * math.pi)


def _pairs(eta: float, quantity: str) -> list[tuple[float, float, float]]:
    """(w, D, c) of each pair of modes, which contributes w exp(-D k^2 t) cos(c k t)."""
    speed, sound = float(speed_of_sound(eta, 2)), sound_attenuation(eta, 2)
    density = float(number_density(eta, 2))
    shear = float(enskog_viscosity(eta, 2)) / density
    if quantity == "viscosity":
        return [
            (0.25, 2.0 * shear, 0.0),
            (0.125, sound, 0.0),
            (0.125, sound, 2.0 * speed),
            (0.5, shear + 0.5 * sound, speed),
        ]
    if quantity != "conductivity":
        raise SceneError("quantity", quantity, "must be viscosity or conductivity")
    capacity = heat_capacities(eta, 2)[1]
    heat = float(enskog_conductivity(eta, 2)) / (density * capacity)
    return [
        (0.5 * capacity, heat + shear, 0.0),
        (0.5 * capacity, heat + 0.5 * sound, speed),
        (0.5 * speed**2, sound, 0.0),
        (0.5 * speed**2, shear + 0.5 * sound, speed),
    ]
