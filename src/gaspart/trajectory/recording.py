"""Main loop of a run, which advances to the next frame, writes it, and stores checkpoints."""

from __future__ import annotations

import math
import shlex
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from gaspart.errors import SceneError, SimulationError
from gaspart.interruption import Deferral, defer_signals, set_note
from gaspart.simulation import Simulation
from gaspart.state.state import State, by_number
from gaspart.trajectory import amber
from gaspart.trajectory.amber import Frames
from gaspart.trajectory.correlator import PairCounter, correlator_for
from gaspart.trajectory.opening import checkpoint_path, write_checkpoint
from gaspart.trajectory.recipe import Recipe, multiple
from gaspart.trajectory.run_options import examined_before, examined_from, is_examined

Progress = Callable[[float, float, int], None]
"""Callback whose arguments are the present time, the duration, and the number of collisions so far.

For a run that ends at an accuracy, the duration is the present estimate.
"""
Examine = Callable[[int], float | None]
"""Function that returns the error after a number of frames, divided by the required error.

The result is infinite if the error is unknown. The result is None as long as another replica has fewer
frames.
"""

_SEGMENT = 0.1  # seconds of work between checks of clock and signals, within a factor of 2
_PROGRESS = 0.5  # seconds between progress reports
_LOOK = 0.05  # seconds between checks of other replicas


class Recording:
    """Simulation in progress, file of its frames, and path of the finished trajectory. The trajectory does
    not depend, even in its last bit, on checkpoints or on the division into segments.

    every : time between checkpoints, in seconds
    examine : function that tests the accuracy, for a run that ends at an accuracy
    """

    def __init__(
        self,
        recipe: Recipe,
        simulation: Simulation,
        frames: Frames,
        path: Path,
        every: float,
        progress: Progress | None,
        examine: Examine | None = None,
    ) -> None:
        self._recipe, self._simulation, self._frames = recipe, simulation, frames
        self._path, self._every, self._progress = path, every, progress
        self._origin = simulation.initial_state.unwrapped
        correlations = recipe.correlations
        self._correlator = correlations and correlator_for(correlations, simulation, recipe.displacements)
        self._pairs = PairCounter(simulation) if recipe.pairs else None
        self._examine = examine
        self._duration = recipe.longest if examine is None else self._estimate(0, math.inf)
        self._segment = recipe.engine.first_segment
        self._saved = self._reported = time.monotonic()

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Continue from the arrays of a checkpoint."""
        self._simulation.restore(arrays)
        if self._correlator:
            self._correlator.restore(arrays)
        if self._pairs:
            self._pairs.restore(arrays)
        if self._simulation.time > 0.0:
            self._note()

    def finish(self, keep: bool = False) -> None:
        """Write all missing frames, and finally a checkpoint if `keep` is True. May raise OSError. Raises
        SimulationError if an invariant is violated; the state is then stored in a file `.failed.npz` next to
        the trajectory. A signal to the process takes effect after a checkpoint has been written.
        """
        try:
            with defer_signals() as signals:
                self._estimate_again()
                while not self._is_complete(signals):
                    self._finish_frame(signals)
                if keep:
                    self._save()
        except SimulationError as error:
            raise SimulationError(f"{error}; {self._keep_failed()}") from None
        self._frames.sync()
        set_note("")

    def _keep_failed(self) -> str:
        """Store the state of a failed run, unless another file has the name; return a message about it."""
        failed = self._path.with_name(self._path.name + ".failed.npz")
        try:
            write_checkpoint(failed, self._frames.header, self._frames.count, self._arrays())
        except SceneError as error:
            return f"its state is not kept: {failed} {error.rule}"
        return f"its state is kept in {failed}"

    def _is_complete(self, signals: Deferral) -> bool:
        """Return True if the file has all frames; wait for other replicas. It depends on the frames only, so
        that an interrupted run ends at the same frame.
        """
        count = self._frames.count
        if count >= self._recipe.frames:
            return True
        if self._examine is None or not is_examined(count):
            return False
        while (excess := self._examine(count)) is None:
            self._between_segments(signals)
            time.sleep(_LOOK)
        self._duration = self._estimate(count, excess)
        return excess <= 1.0

    def _estimate(self, frames: int, excess: float) -> float:
        """Return the time at which a run is expected to reach its accuracy. Errors decrease as 1 /
        sqrt(time). `excess`: present error divided by the required error.
        """
        required_frames = frames * excess**2 if math.isfinite(excess) else 0.0
        expected = examined_from(min(max(required_frames, frames + 1.0), self._recipe.frames))
        return min((expected - 1) * self._recipe.sample_interval, self._recipe.longest)

    def _estimate_again(self) -> None:
        """Estimate the duration of a continued run for progress reports alone."""
        before = examined_before(self._frames.count)
        if self._progress and self._examine and before is not None:
            if (excess := self._examine(before)) is not None:
                self._duration = self._estimate(before, excess)

    def _finish_frame(self, signals: Deferral) -> None:
        """Add the missing samples of the present frame interval to the correlations, and write the frame."""
        frame, correlator = self._frames.count, self._correlator
        last = frame * self._recipe.samples_per_frame
        while correlator and correlator.next < last:
            self._reach(correlator.next, correlator.interval, signals)
            correlator.add(self._simulation)
        self._reach(frame, self._recipe.sample_interval, signals)
        if correlator and correlator.next == last:
            correlator.add(self._simulation)
        state = self._simulation.state
        self._simulation.check_invariants(state)
        self._frames.append(self._frame(state))
        self._between_segments(signals)

    def _reach(self, number: int, interval: float, signals: Deferral) -> None:
        """Advance to the time `number` x `interval`."""
        for _ in self._approach(number, interval):
            signals.unsaved = True
            self._between_segments(signals)

    def _between_segments(self, signals: Deferral) -> None:
        """Report progress, write a checkpoint and deliver a signal, each if it is due."""
        now = time.monotonic()
        if self._progress and now - self._reported >= _PROGRESS:
            collisions = self._simulation.tally.collisions
            self._progress(self._simulation.time, self._duration, collisions)
            self._reported = now
        if signals.pending is not None:
            self._save()
            signals.deliver()
        elif now - self._saved >= self._every:
            self._save()

    def _save(self) -> None:
        """Write a checkpoint, from which the run can continue bitwise identically."""
        self._simulation.check_invariants()
        self._frames.sync()  # before the checkpoint, which stores their number
        write_checkpoint(checkpoint_path(self._path), self._frames.header, self._frames.count, self._arrays())
        self._note()
        self._saved = time.monotonic()

    def _arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays of a checkpoint."""
        correlations = self._correlator.checkpoint() if self._correlator else {}
        pairs = self._pairs.checkpoint() if self._pairs else {}
        return {**self._simulation.checkpoint(), **correlations, **pairs}

    def _note(self) -> None:
        command = f"gaspart resume {shlex.quote(str(self._path))}"
        end = "" if self._recipe.duration is None else f" of {self._recipe.duration:g}"
        set_note(f"`{command}` continues it from time {self._simulation.time:g}{end}")

    def _approach(self, number: int, interval: float) -> Iterator[None]:
        """Advance to the time `number` x `interval` in segments."""
        simulation, recipe = self._simulation, self._recipe
        if step := recipe.engine.quantum:
            goal = number * multiple("interval", interval, "time_step", step)
            while (done := round(simulation.time / step)) < goal:
                # half a step beyond the goal, so that rounding does not omit a step
                self._advance(goal * step, until=(min(goal, done + self._segment) + 0.5) * step)
                yield
            return
        until = number * interval
        while simulation.time < until:
            self._advance(until, until=until, max_work=self._segment)
            yield
        simulation.advance(until=until)  # remaining events at exactly this time
        if self._pairs:
            self._pairs.take()

    def _advance(self, goal: float, **limits: Any) -> None:
        """Advance by a segment, of about `_SEGMENT` seconds, towards the time `goal`."""
        begun = time.monotonic()
        self._simulation.advance(**limits)
        if self._pairs:
            self._pairs.take()
        took = time.monotonic() - begun
        if took > _SEGMENT * 2:
            self._segment = max(1, self._segment // 2)
        elif took < _SEGMENT / 2 and self._simulation.time < goal:
            self._segment *= 2

    def _frame(self, state: State) -> dict[str, np.ndarray | float]:
        """Return the present state and counters as the variables of a frame."""
        counted = amber.counters(self._recipe.engine, self._recipe.tallied)
        tally, followed = self._simulation.tally, slice(self._recipe.stored_count)
        inner: dict[str, np.ndarray] = {}
        if self._recipe.scene.rough:
            flat = state.dimension == 2
            inner["spins"] = np.pad(state.spins[:, None], ((0, 0), (2, 0))) if flat else state.spins
        if state.vibrations is not None:
            inner["vibrations"] = state.vibrations
        if self._recipe.displacements:
            inner["displacements"] = state.unwrapped[followed] - self._origin[followed]
        return {
            "time": state.time,
            **amber.cell(self._recipe.scene, state.lengths, state.piston),
            "kinetic_energy": state.kinetic_energy,
            **{name: getattr(tally, name) for name in counted},
            "coordinates": by_number(state, state.positions, self._recipe.scene.capacity)[followed],
            "velocities": by_number(state, state.velocities, self._recipe.scene.capacity)[followed],
            **(self._correlator.sums() if self._correlator else {}),
            **{name: values[followed] for name, values in inner.items()},
            **({} if state.piston is None else {"piston": state.piston}),
            **({"pair_collisions": self._pairs.counts} if self._pairs else {}),
        }
