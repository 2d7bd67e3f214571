"""Made-up trajectories instead of files."""

from gaspart.analysis.run import Run
from gaspart.reproduction.points import grid


def runs_of(files):
    """Stands in for `shared.runs.runs`: those of the data sets that `files` has for the paths of replicas."""

    def runs(point, first=None):
        first = grid.schedule(point).equilibration_frames if first is None else first
        for path in point.replica_paths:
            data = files[path].isel(frame=slice(first, None))
            yield Run(grid.scene(point), data["time"].values, data)

    return runs
