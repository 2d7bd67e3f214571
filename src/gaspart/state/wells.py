"""Potential wells at the faces of a container: depths, and which particles are inside."""

from __future__ import annotations

import numpy as np

from gaspart.scene.faces import FACES, Well
from gaspart.scene.scene import Scene


def wells_of(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """(2d,), (2d,) depths and widths of the wells at all faces, 0 where there is none."""
    faces = (scene.faces.get(name) for name in FACES[: 2 * scene.dimension])
    wells = [(face.depth, face.width) if isinstance(face, Well) else (0.0, 0.0) for face in faces]
    depths, widths = np.array(wells).T
    return depths, widths


def places_in_wells(scene: Scene, positions: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """(N, d) -1 where a particle is in the well of an axis' low face, 1 in that of the high face, else 0."""
    margins = 0.0 if scene.centres_to_walls else radii[:, None]
    _, widths = wells_of(scene)
    low = positions - margins < widths[::2]
    high = np.array(scene.container.lengths) - positions - margins < widths[1::2]
    return high.astype(np.int8) - low.astype(np.int8)


def well_energies(scene: Scene, places: np.ndarray) -> np.ndarray:
    """(N,) the potential energy of particles in these places."""
    depths, _ = wells_of(scene)
    return -(np.where(places < 0, depths[::2], 0.0) + np.where(places > 0, depths[1::2], 0.0)).sum(axis=1)
