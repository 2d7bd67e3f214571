import numpy as np
from reproduction.families.drawn import Points, draw, shows
from reproduction.families.piston.data import REPLICAS, gases

from gaspart import theory
from gaspart.reproduction.families.piston import figure


def of_replicas(values):
    """Mean and standard error over the last axis."""
    return values.mean(axis=-1), values.std(axis=-1, ddof=1) / np.sqrt(REPLICAS.size)


def test_paths_states_and_an_expansion():
    ds = gases(exponent=1.1, back=0.9, factor=1.02, fluctuation=0.9, speed=1.01)
    upper, middle, lower = draw(figure.piston, ds).axes
    paths, factors, variances = [], [], []
    for n in range(2):
        own = ds.isel(path=n)
        measured = of_replicas(own["path_temperature"].values.T)
        paths.append(Points(own["path_volume"].mean("path_replica"), *measured))
        states = ds.isel(state=slice(2 * n, 2 * n + 2))
        eta = states["state_density"].values
        factor = states["state_factor"].values / theory.compressibility_factor(eta, n + 2)
        variance = states["state_fluctuation"].values * theory.speed_of_sound(eta, n + 2) ** 2
        factors.append(Points(eta[:, 0], *of_replicas(factor)))
        variances.append(Points(eta[:, 0], *of_replicas(variance)))
    speed = ds["expansion_speed"].values[0] ** 2
    paths.append(Points([2.0], *([one] for one in of_replicas(speed))))
    shows(upper, *paths)
    shows(middle, *factors)
    shows(lower, *variances)
