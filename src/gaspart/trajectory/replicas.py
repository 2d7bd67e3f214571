"""Replicas of a run: their seeds and their files.

Replica k of `run.nc` has the seed of the run followed by k, and the file `run-k.nc`. If replicas end at an
accuracy, they end together, at a test of the accuracy of their mean. For this test, each replica reads the
files of the others. A test uses only frames that do not change any more. Therefore the decision does not
depend on interruptions, or on the order in which replicas advance.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gaspart.errors import SceneError
from gaspart.files import open_regular
from gaspart.keys.values import count_of
from gaspart.trajectory.amber import frame_count
from gaspart.trajectory.opening import PARTIAL, partial_path, replica_path
from gaspart.trajectory.reading import open_trajectory
from gaspart.trajectory.recipe import MOST_REPLICAS, Recipe, begun_as, read_recipe

if TYPE_CHECKING:
    import xarray as xr

    from gaspart.engines import Engine
    from gaspart.scene.scene import Scene


def in_replicas(recipe: Recipe, replicas: int) -> list[Recipe]:
    """Return the recipes of the replicas of a run; for 1 replica, the recipe itself."""
    if count_of("replicas", replicas, least=1, most=MOST_REPLICAS) == 1:
        return [recipe]
    if not differ(recipe.scene, recipe.engine, recipe.initial is not None):
        rule = "would be one run, bit for bit: they start from one state, and nothing is drawn after that"
        raise SceneError("replicas", replicas, rule)
    return [replace(recipe, seed=_seed(recipe, k), replica=(k, replicas)) for k in range(1, replicas + 1)]


def differ(scene: Scene, engine: Engine, has_initial: bool = False) -> bool:
    """Return True if runs of other seeds differ: random numbers are drawn at the start or later."""
    drawn = not has_initial and (scene.vibrates or any(kind.count for kind in scene.species))
    return drawn or engine.draws(scene)


def _seed(recipe: Recipe, number: int) -> tuple[int, ...]:
    """Return the seed of a replica."""
    seed = recipe.seed if isinstance(recipe.seed, tuple | list) else (recipe.seed,)
    return (*seed, number)


def of_all(recipe: Recipe) -> tuple[Recipe, int]:
    """Return the recipe of the run to which a replica belongs, and the number of replicas."""
    if recipe.replica is None:
        return recipe, 1
    assert isinstance(recipe.seed, tuple)  # checked by `Recipe`
    seed = recipe.seed[:-1]
    return replace(recipe, seed=seed[0] if len(seed) == 1 else seed, replica=None), recipe.replica[1]


def replica_paths(path: str | Path, replicas: int) -> list[Path]:
    """Return the files of a run at a path, one for each replica.

    Parameters
    ----------
    path : str or Path
        Path of the run.
    replicas : int
        Number of replicas.

    Returns
    -------
    list of Path
        The path itself, or, for several replicas of ``run.nc``, the paths ``run-1.nc``, ``run-2.nc`` ...

    Examples
    --------
    >>> import gaspart as gp
    >>> [str(path) for path in gp.replica_paths("run.nc", 2)]
    ['run-1.nc', 'run-2.nc']
    """
    path = Path(path)
    if replicas == 1:
        return [path]
    return [replica_path(path, k) for k in range(1, replicas + 1)]


def path_of_all(path: Path, recipe: Recipe) -> Path:
    """Return the path of the run to which a file belongs."""
    path = path.with_name(path.name.removesuffix(PARTIAL))
    if recipe.replica is None:
        return path
    return path.with_name(f"{path.stem.removesuffix(f'-{recipe.replica[0]}')}{path.suffix}")


def beside(path: Path, recipe: Recipe) -> list[tuple[Path, Recipe]]:
    """Return the paths of the finished files, and the recipes, of all replicas of a run."""
    common, replicas = of_all(recipe)
    if replicas == 1:
        return [(path, recipe)]
    paths = replica_paths(path_of_all(path, recipe), replicas)
    return list(zip(paths, in_replicas(common, replicas), strict=True))


def find_run(path: str | Path) -> tuple[Path, Recipe]:
    """Return a file of the run at a path, its own or its first replica's, and its recipe."""
    path = Path(path)
    first = replica_paths(path, 2)[0] if path.name else path
    file = next(
        (candidate for candidate in (path, partial_path(path), *_places(first)) if candidate.exists()), path
    )
    return file, read_recipe(file)


def run_files(path: str | Path) -> list[str]:
    """Return the file at a path, or the files of all its replicas."""
    stated, path = str(path), Path(path)
    alone = path.exists() or partial_path(path).exists() or not path.name
    first = path if alone else replica_path(path, 1)
    is_replicated = first != path and (first.exists() or partial_path(first).exists())
    return [str(file) for file in files_of(path)] if is_replicated else [stated]


def files_of(path: str | Path) -> list[Path]:
    """Return the files of the run at a path, finished or unfinished."""
    first, recipe = find_run(path)
    if recipe.replica is None:
        return [first]
    files = []
    for target, target_recipe in beside(first, recipe):
        there = [
            candidate
            for candidate in _places(target)
            if candidate.exists() and read_recipe(candidate) == target_recipe
        ]
        if not there:
            rule = f"is not there: it is one of {recipe.replica[1]} replicas, which are one run"
            raise SceneError("file", str(target), rule)
        files.append(there[0])
    return files


def _places(path: Path) -> tuple[Path, Path]:
    """Return the paths of a trajectory when it is finished and when it is unfinished."""
    return path, partial_path(path)


def find_replicas(files: Sequence[tuple[Path, Recipe]], frames: int) -> list[Path] | None:
    """Return the files of all replicas if each has the required number of frames."""
    if len(files) == 1:
        return [files[0][0]]
    available = [_with_frames(path, recipe, frames) for path, recipe in files]
    return [item for item in available if item] if all(available) else None


def _with_frames(path: Path, recipe: Recipe, frames: int) -> Path | None:
    """Return the file of a replica if it has this number of frames; otherwise None."""
    for candidate in _places(path):
        with suppress(SceneError, OSError, struct.error):  # the file does not exist yet, or is empty
            with open_regular(candidate) as file:
                enough = frame_count(file) >= frames
            if enough and begun_as(candidate, recipe):
                return candidate
    return None


@contextmanager
def opened_together(paths: Sequence[Path]) -> Iterator[list[xr.Dataset]]:
    """Open several trajectories, which are closed at the end of the `with` block."""
    with ExitStack() as stack:
        yield [stack.enter_context(open_trajectory(path)) for path in paths]
