"""Potential wells at the faces of a container: depths, and which particles are inside."""

from __future__ import annotations

import numpy as np

from gaspart.scene.faces import FACES, Well
from gaspart.scene.scene import Scene


def wells_of(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return the depths and widths of the wells at all faces.

    Parameters
    ----------
    scene : Scene
        Scene of the faces.

    Returns
    -------
    depths : ndarray, shape (2d,), [energy]
        Depths, 0 where there is no well.
    widths : ndarray, shape (2d,), [length]
        Widths, 0 where there is no well.
    """
    faces = (scene.faces.get(name) for name in FACES[: 2 * scene.dimension])
    wells = [(face.depth, face.width) if isinstance(face, Well) else (0.0, 0.0) for face in faces]
    depths, widths = np.array(wells).T
    return depths, widths


def places_in_wells(scene: Scene, positions: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """Return the wells in which particles are.

    Parameters
    ----------
    scene : Scene
        Scene of the faces.
    positions : ndarray, shape (N, d), [length]
        Positions.
    radii : ndarray, shape (N,), [length]
        Radii.

    Returns
    -------
    ndarray of int8, shape (N, d)
        -1 in the well of an axis' low face, 1 in the well of the high face, otherwise 0.
    """
    margins = 0.0 if scene.centres_to_walls else radii[:, None]
    _, widths = wells_of(scene)
    low = positions - margins < widths[::2]
    high = np.array(scene.container.lengths) - positions - margins < widths[1::2]
    return high.astype(np.int8) - low.astype(np.int8)


def well_energies(scene: Scene, places: np.ndarray) -> np.ndarray:
    """Return the potential energy of particles in wells.

    Parameters
    ----------
    scene : Scene
        Scene of the faces.
    places : ndarray of int8, shape (N, d)
        Wells of the particles, by `places_in_wells`.

    Returns
    -------
    ndarray, shape (N,), [energy]
        Energies.
    """
    depths, _ = wells_of(scene)
    return -(np.where(places < 0, depths[::2], 0.0) + np.where(places > 0, depths[1::2], 0.0)).sum(axis=1)
