"""Digests of the physics in the smoke run: the numbers, not the attributes that state versions.

python tests/workflow/digests.py FOLDER            compare all simulations below a folder with digests.json
python tests/workflow/digests.py FOLDER --renew    write digests.json
python tests/workflow/digests.py --due             exit code 0 if kernels, engines or state differ from the
                                                   sources of digests.json, so that a comparison is due
"""

import argparse
import hashlib
import json
import sys
from pathlib import Path

from netCDF4 import Dataset

from gaspart.kernels.compile.sources import file_digests

STORE = Path(__file__).parent / "digests.json"
SOURCES = Path(__file__).parents[2] / "src/gaspart"
DECISIVE = ("kernels", "engines", "state")
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


def known():
    """{trajectory: digest} of the smoke run."""
    return json.loads(STORE.read_text())["trajectories"]


def source_digest():
    """Return a hash of the packages that decide the bits; docstrings and comments do not change it."""
    paths = sorted(path for name in DECISIVE for path in (SOURCES / name).rglob("*.py"))
    lines = zip((path.relative_to(SOURCES).as_posix() for path in paths), file_digests(paths), strict=True)
    return hashlib.sha256("\n".join(map(" ".join, lines)).encode()).hexdigest()[:16]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", nargs="?", help="results/smoke/points")
    parser.add_argument("--renew", action="store_true")
    parser.add_argument("--due", action="store_true")
    options = parser.parse_args()
    if options.due:
        return int(json.loads(STORE.read_text())["sources"] == source_digest())
    made = digests(options.folder)
    if options.renew:
        STORE.write_text(json.dumps({"sources": source_digest(), "trajectories": made}, indent=1) + "\n")
        return 0
    before = known()
    differing = [name for name in sorted(made | before) if made.get(name) != before.get(name)]
    print(f"{len(made)} simulations, {len(differing)} differ from {STORE.name}", *differing, sep="\n")
    return int(bool(differing))


if __name__ == "__main__":
    sys.exit(main())
