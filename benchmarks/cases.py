"""What is timed: scenes by number, packing fraction, dimension, feature and engine, and what peers reach.

The peers' numbers were taken by this project on another machine of this kind (two cores, x86-64), each
program at its best setting, on one core: Smallenburg's event-driven program in C, the best of its three
variants (Eur. Phys. J. E 45, 22 (2022)); Spencer's *billiards* in C++ and Cython (2022); the C program of
Frederickx & Meerts (2010), compiled with gcc -O3 -march=native, at its best number of boxes. DynamO
(Bannerman et al., J. Comput. Chem. 32, 3329 (2011)) reached 0.11 to 0.18 million collisions a second at 10
thousand spheres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import gaspart as gp

SMALL = 64
"""Particles of a case when only its code is to be tried."""

SMALLENBURG = {  # million collisions a second, by number of spheres and packing fraction
    10**3: {0.05: 0.87, 0.2: 0.95, 0.3: 0.92, 0.49: 1.61},
    10**4: {0.05: 0.72, 0.2: 0.83, 0.3: 0.70, 0.49: 1.30},
    10**5: {0.05: 0.40, 0.2: 0.49, 0.3: 0.47, 0.49: 0.83},
    10**6: {0.05: 0.14, 0.2: 0.20, 0.3: 0.19, 0.49: 0.42},
}
SPENCER = {  # the same, of discs between walls
    10**4: {0.05: 0.13, 0.2: 0.24, 0.4: 0.33, 0.6: 0.33},
    10**5: {0.05: 0.05, 0.2: 0.08, 0.4: 0.09, 0.6: 0.11},
}
FREDERICKX = {10**4: 113.0, 10**5: 146.0, 1_200_000: 339.0}
"""ns for a particle and a step: spheres of radius 0.1 in 50^3, steps of 0.01."""


@dataclass(frozen=True)
class Case:
    """One thing to time. peer: whose number stands beside it; peer_value, in the case's unit."""

    engine: str
    dimension: int
    count: int
    packing_fraction: float
    feature: str = "plain"
    peer: str = ""
    peer_value: float = math.nan

    @property
    def name(self) -> str:
        return f"{self.engine}-{self.dimension}d-{self.count}-{self.packing_fraction:g}-{self.feature}"

    @property
    def unit(self) -> str:
        return "collisions/s" if self.engine == "event" else "ns per particle and step"

    def small(self) -> Case:
        """The same with a few particles, to try the code."""
        return Case(self.engine, self.dimension, SMALL, self.packing_fraction, self.feature)


def _event(dimension: int, table: dict, peer: str) -> list[Case]:
    return [
        Case("event", dimension, count, eta, peer=peer, peer_value=1e6 * rate)
        for count, rates in table.items()
        for eta, rate in rates.items()
    ]


def _dilute(count: int) -> float:
    """The packing fraction of so many spheres of radius 0.1 in 50^3."""
    return count * 4.0 / 3.0 * math.pi * 0.1**3 / 50.0**3


EVENT = [
    *_event(3, SMALLENBURG, "Smallenburg 2022, C"),
    *_event(2, SPENCER, "Spencer 2022, C++"),
    *(Case("event", 2, 10**4, 0.2, feature) for feature in ("gravity", "rough", "two masses", "recording")),
]
STEP = [
    *(
        Case("step", 3, count, _dilute(count), peer="Frederickx & Meerts 2010, C", peer_value=ns)
        for count, ns in FREDERICKX.items()
    ),
    Case("step", 3, 10**5, 0.1),
    Case("step", 3, 10**5, 0.3),
    Case("step", 3, 10**5, 0.1, "float32"),
    Case("step", 3, 1_200_000, _dilute(1_200_000), "two threads"),
]


def scene(case: Case) -> gp.Scene:
    """Spheres between periodic faces, discs between walls, of diameter 1 and temperature 1, on a lattice; in
    steps, those of 2010 at their speed of 1."""
    unit = math.pi / 4.0 if case.dimension == 2 else math.pi / 6.0
    side = (case.count * unit / case.packing_fraction) ** (1.0 / case.dimension)
    container = gp.Container((side,) * case.dimension, "wall" if case.dimension == 2 else "periodic")
    properties = {"radius": 0.5, "temperature": 1.0, "arrangement": "lattice"}
    if case.feature != "two masses":
        species = [gp.Species(case.count, **properties)]
    else:
        species = [gp.Species(case.count // 2, mass=mass, **properties) for mass in (1.0, 4.0)]
    rest = {}
    if case.feature == "gravity":
        rest["gravity"] = (0.0, -1.0 / side)
    if case.feature == "rough":
        rest["restitution"] = gp.Restitution(1.0, 1.0)  # a gas that loses energy has other contacts
    return gp.Scene(container, species, **rest)


def engine(case: Case):
    """The engine of a case; steps of 2010, a twentieth of a diameter of flight, shorter where it is dense."""
    if case.engine == "event":
        return gp.EventDriven()
    step = 0.03 if case.packing_fraction < 0.05 else 0.02
    return gp.TimeStepped(
        step,
        precision="float32" if case.feature == "float32" else "float64",
        threads=2 if case.feature == "two threads" else 1,
    )
