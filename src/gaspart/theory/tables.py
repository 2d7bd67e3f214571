"""Tables of values that programs have measured: this program and others."""

from functools import cache
from pathlib import Path

import numpy as np

from gaspart.errors import SceneError
from gaspart.theory._arguments import checked_dimension


def literature(quantity: str, dimension: int) -> np.recarray:
    """Return values of hard discs and spheres that programs of others have measured and published.

    Parameters
    ----------
    quantity : str
        For spheres "Z", "Z_crystal" (face-centred cubic), "diffusion", "viscosity" or "conductivity"; for
        discs "pressure", from the liquid to the hexatic.
    dimension : {2, 3}
        Discs or spheres.

    Returns
    -------
    numpy.recarray
        A row for each value. Its fields, which are attributes of the array, are `packing_fraction`; `count`,
        the number of particles; `container` ("cube", "square", or the sides of "29 x 30" discs of a
        triangular lattice), periodic; `value` and its standard `error`, with diameter = mass = k_B T = 1;
        `source`.

    Raises
    ------
    SceneError
        If the table does not have the quantity.

    See Also
    --------
    measured : Values that this program has measured.

    Notes
    -----
    No value is corrected for its number of particles. The provenance of all values is in `data/README.md`.

    Examples
    --------
    >>> from gaspart import theory
    >>> rows = theory.literature("Z", 3)
    >>> len(rows), int(rows.count.max())
    (193, 2125764)
    """
    return _of("literature", quantity, dimension)


def measured(quantity: str, dimension: int) -> np.recarray:
    """Return values of hard discs and spheres that this program has measured, to be cited.

    Parameters
    ----------
    quantity : {"Z", "contact_value", "viscosity", "bulk_viscosity", "conductivity", "diffusion"}
        Quantity; "diffusion" exists for spheres only.
    dimension : {2, 3}
        Discs or spheres.

    Returns
    -------
    numpy.recarray
        A row for each value, with the fields and units of `literature`. `source` is the figure of the
        reproduction.

    Raises
    ------
    SceneError
        If the table does not have the quantity.

    See Also
    --------
    literature : Values that programs of others have measured.

    Notes
    -----
    All values are of fluids. "Z" and "contact_value" are values of the infinite system: the effect of finite
    numbers is subtracted to the first order in 1/N. "viscosity", "bulk_viscosity" and "conductivity" are by
    Green and Kubo until 16 collisions of a particle (30 in dense gases). "diffusion" is N / (N - 1) times the
    diffusion of particles whose total momentum is zero. The last four are values of `count` particles; for
    discs they grow with the logarithm of time and of the container. The commit and the command that made the
    table are in `data/README.md`.

    Examples
    --------
    >>> from gaspart import theory
    >>> rows = theory.measured("Z", 3)
    >>> rows.dtype.names
    ('dimension', 'quantity', 'packing_fraction', 'count', 'container', 'value', 'error', 'source')
    """
    return _of("measured", quantity, dimension)


def small_systems(quantity: str, dimension: int) -> np.recarray:
    """Return what this program has measured of few particles in a periodic square or cube.

    Parameters
    ----------
    quantity : {"contact_value", "Z", "collision_rate", "diffusion"}
        Quantity of equal particles at fixed energy and zero total momentum.
    dimension : {2, 3}
        Discs or spheres.

    Returns
    -------
    numpy.recarray
        A row for each system, with the fields of `literature`.

    Raises
    ------
    SceneError
        If the table does not have the quantity.

    See Also
    --------
    finite_contact_value : Contact value between the rows of the table.

    Notes
    -----
    Diameter = mass = k_B T = 1, with k_B T = 2 E / (d (N - 1)). "contact_value": density of pairs at contact
    divided by N (N - 1) / V^2. "Z" and "collision_rate" follow from it exactly (`finite_contact_value`): Z is
    the canonical one, which `gaspart.analysis.compressibility_factor` measures, the rate is 2 N_coll / (N t).
    "diffusion": slope of the mean-squared displacement about the centre of mass divided by 2 d. Errors are
    standard deviations by independent runs. Recipe and seeds are in `data/README.md`.

    Examples
    --------
    >>> from gaspart import theory
    >>> rows = theory.small_systems("contact_value", 3)
    >>> int(rows.count.max()) >= 64
    True
    """
    return _of("small_systems", quantity, dimension)


def _of(table: str, quantity: str, dimension: int) -> np.recarray:
    """Return the rows of a quantity; raise SceneError if the table has no row."""
    rows = _read(table)
    same = rows[rows.dimension == checked_dimension(dimension)]
    found = same[same.quantity == quantity]
    if not len(found):
        raise SceneError("quantity", quantity, f"must be one of {', '.join(np.unique(same.quantity))}")
    return found


@cache
def _read(table: str) -> np.recarray:
    """Return the rows of a table."""
    path = Path(__file__).parent / "data" / f"{table}.csv"
    return np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8").view(np.recarray)
