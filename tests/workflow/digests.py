"""Digests of the physics in a folder of trajectories: the numbers, not the attributes that tell versions."""

import hashlib
import json
import sys
from pathlib import Path

from netCDF4 import Dataset

PHYSICS = ["time", "coordinates", "velocities", "collisions", "virial_sum", "displacements"]
PHYSICS += ["stress_sum", "heat_sum", "pair_collisions", "momentum_flux_sum"]


def digest(path):
    """The digest of one trajectory."""
    total = hashlib.sha256()
    with Dataset(path) as file:
        file.set_auto_mask(False)
        for name in PHYSICS:
            if name in file.variables:
                total.update(name.encode())
                total.update(file.variables[name][:].tobytes())
    return total.hexdigest()[:16]


def digests(folder):
    """{trajectory: digest} of all below a folder."""
    folder = Path(folder)
    return {str(path.relative_to(folder)): digest(path) for path in sorted(folder.glob("*/*/replica-*.nc"))}


if __name__ == "__main__":
    print(json.dumps(digests(sys.argv[1]), indent=1))
