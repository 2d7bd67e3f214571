"""Made-up trajectories instead of files."""

from gaspart.analysis.run import Run


def runs_of(files):
    """Stands in for `shared.runs.runs`: those of the data sets that `files` has for the paths of replicas."""

    def runs(point, first=None):
        first = point.schedule.equilibration_frames if first is None else first
        for path in point.replica_paths:
            data = files[path].isel(frame=slice(first, None))
            yield Run(point.scene, data["time"].values, data)

    return runs
