"""The candidates of a scene with their speeds, and the pilots that show what they are like."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from gaspart.accuracy.candidates import candidates, suited
from gaspart.accuracy.conditions import Conditions, measured_conditions
from gaspart.accuracy.estimates import Component
from gaspart.accuracy.pilot import Pilot, require_defined, run_pilot, speed_of
from gaspart.accuracy.target import Target
from gaspart.engines import Engine, reference_engine
from gaspart.engines.asked import Candidate
from gaspart.errors import SceneError
from gaspart.state.given import state_at_time_zero
from gaspart.trajectory.last_state import last_state

DIFFERS = 2.5
"""Standard errors by which two pilots differ if one is biased more than theory says."""
_CERTAIN = 1.96
"""Standard errors of a difference that are added to it for a bound on a bias."""
_PREPARED = 5.0
"""Processor seconds until pilots begin that are not taken from theirs."""
Announce: TypeAlias = Callable[[str], None]


@dataclass
class Trials:
    """What is known of the engines for a target. seconds: of processor time for all pilots; speeds: processor
    time of a unit of time by candidate; refused: why other engines are none; pilots: made so far, that of the
    exact engine first; target: starts from a steady state where a pilot has shown one."""

    target: Target
    accuracy: float
    seconds: float
    announce: Announce
    speeds: dict[Candidate, float] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)
    pilots: list[Pilot] = field(default_factory=list)
    _begun: float = field(default_factory=time.process_time)

    def begin(self) -> None:
        """Find the candidates and make the pilot of the exact engine: of half the time if another engine may
        be cheaper. Raises SceneError if no engine runs the scene, and for an observable that it does not
        have."""
        engines, self.refused = suited(self.target)
        if not engines or not engines[0].reference:
            raise self._no_engine()
        exact = Candidate(reference_engine())
        require_defined(self.target)
        conditions = self.target.conditions
        if conditions is not None and conditions.axis is None:
            self._time(self._able(conditions))
            known = self.speeds.get(exact, math.inf)
            cheaper = any(speed < known for one, speed in self.speeds.items() if one.bias < self.accuracy)
            self.make(exact, 0.5 if cheaper else 1.0)
            self._ask_another()
            return
        self._time([exact])
        rivals = len(engines) > 1 and self.target.declared.samples != "structure"
        pilot = self.make(exact, 0.5 if rivals else 1.0)
        if pilot.path is None:
            rule = f"the pilot of the {exact.engine.title} engine failed: {pilot.rule}"
            raise SceneError("observable", self.target.name, rule)
        if conditions is None:
            conditions = measured_conditions(self.target.scene, pilot.path)
        self._settle(pilot)
        self._time(self._able(conditions))
        self._ask_another()

    def make(self, candidate: Candidate, part: float = 0.5) -> Pilot:
        """One more pilot, with a part of the processor time; a third one, and a fourth, with less."""
        if candidate not in self.speeds:
            raise self._no_engine()
        spent = 0.0 if self.pilots else time.process_time() - self._begun
        left = min(1.0, max(0.5, 1.0 - (spent - _PREPARED) / self.seconds))
        seconds, engine = part * self.seconds / max(1, len(self.pilots)), candidate.engine
        self.announce(f"a pilot run, {engine.title} engine, {left * seconds:.2g} s")
        found = run_pilot(self.target, engine, seconds, self.speeds[candidate], left)
        self.pilots.append(found)
        return found

    def _ask_another(self) -> None:
        """Make a pilot of the cheapest accurate engine if that of the exact one has measured nothing."""
        able = [one for one in self.speeds if one.bias < self.accuracy and not self.has_pilot(one.engine)]
        if able and not self.known:
            self.make(min(able, key=lambda one: self.speeds[one]))

    def refuse(self, candidate: Candidate, rule: str) -> None:
        """Let a candidate be none."""
        self.refused[candidate.engine.timed_as] = rule
        del self.speeds[candidate]

    def has_pilot(self, engine: Engine) -> bool:
        """Whether an engine has one."""
        return any(one.engine == engine for one in self.pilots)

    def bias(self, candidate: Candidate) -> float:
        """The bound on a candidate's bias: that of theory, or what its pilot differs by from the exact
        engine's."""
        own = [one for one in self.known if one.engine == candidate.engine]
        return raised_bias(candidate, own[0], self.known) if own else candidate.bias

    @property
    def known(self) -> list[Pilot]:
        """The pilots that have measured the observable."""
        return [one for one in self.pilots if 0.0 < one.accuracy < math.inf]

    @property
    def differing(self) -> tuple[Pilot, ...]:
        """Those that differ from that of the exact engine by more than their bounds."""
        found = ((one, self._candidate(one.engine)) for one in self.known)
        return tuple(pilot for pilot, one in found if one and self.bias(one) > one.bias)

    @property
    def reference(self) -> Pilot:
        """The longest pilot of an engine that is accurate enough, of any if there is none. Raises SceneError
        if the observable was not measured."""
        accurate = [one for one in self.known if self._is_accurate(one)] or self.known
        if accurate:
            return max(accurate, key=lambda one: one.measured)
        target = self.target
        rule = f"{self.pilots[0].rule or 'does not change in the pilot run'}; allow longer pilots"
        if target.declared.of_impulses and not target.face:
            rule += f", or state a wall, as in {target.observable}:{target.scene.container.walls[0]}"
        raise SceneError("observable", target.observable, rule)

    def noise(self, engine: Engine) -> Component:
        """Of the observable in a run by an engine: of one that keeps impulses that in a pilot with these, of
        any other that of counts. Raises SceneError as `reference`."""
        with_impulses = [one for one in self.known if one.counted]
        if with_impulses and self.target.tallies(engine):
            found = max(with_impulses, key=lambda one: one.measured).component
        else:
            found = self.reference.counted or self.reference.component
        assert found is not None
        return found

    def _is_accurate(self, pilot: Pilot) -> bool:
        one = self._candidate(pilot.engine)
        return one is not None and self.bias(one) < self.accuracy

    def _candidate(self, engine: Engine) -> Candidate | None:
        return next((one for one in self.speeds if one.engine == engine), None)

    def _able(self, conditions: Conditions) -> list[Candidate]:
        able, refused = candidates(self.target, self.accuracy, conditions)
        self.refused |= refused
        return able

    def _time(self, able: list[Candidate]) -> None:
        """Measure the speeds of candidates; those that cannot start are none."""
        for one in able:
            self.announce(f"timing the {one.engine.title} engine")
            try:
                self.speeds[one] = speed_of(self.target, one.engine)
            except SceneError as error:  # as of particles from which the engine cannot start
                self.refused[one.engine.timed_as] = f"{error.key}: {error.rule}"

    def _settle(self, pilot: Pilot) -> None:
        """Start what follows from the end of a pilot, if its file holds the state."""
        try:
            state = state_at_time_zero(self.target.scene, last_state(pilot.path or ""))
        except SceneError:  # as of a piston
            return
        self.target = replace(self.target, settled=state)

    def _no_engine(self) -> SceneError:
        rule = f"no engine runs this scene: {'; '.join(self.refused.values())}"
        return SceneError("engine", ", ".join(self.refused), rule)


def raised_bias(candidate: Candidate, own: Pilot, pilots: list[Pilot]) -> float:
    """The bound on a candidate's bias, with what its own pilot differs by from that of the exact engine."""
    exact = [one for one in pilots if one.engine.reference]
    if candidate.engine.reference or not exact:
        return candidate.bias
    difference = abs(own.value / exact[0].value - 1.0)
    error = math.hypot(own.accuracy, exact[0].accuracy)
    if difference <= candidate.bias + DIFFERS * error:
        return candidate.bias
    return difference + _CERTAIN * error
