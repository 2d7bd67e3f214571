"""`gaspart theory`: a value of theory, with its uncertainty, source and range of validity."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

from gaspart.cli.arguments import Parser, real, set_command, several
from gaspart.errors import SceneError

_PARTICLE = ("diameter", "temperature", "mass")
_STATE = {
    2: "virial series to B10 with a linear tail (Clisby and McCoy 2006)",
    3: "Kolafa, Labik and Malijevsky 2004",
}
_FLUID = {2: "the fluid of discs", 3: "the fluid of spheres (metastable from 0.4915)"}


@dataclass(frozen=True)
class _Quantity:
    """A function of gaspart.theory, the particle's properties that it depends on, its meaning and source."""

    function: str
    takes: tuple[str, ...]
    meaning: str
    source: dict[int, str]


_RATE = {d: f"exact in equilibrium, with g(sigma) from: {source}" for d, source in _STATE.items()}
_ENSKOG = {
    2: "Enskog's theory (Gass 1971), with g(sigma) from: " + _STATE[2],
    3: "Enskog's theory (Chapman and Cowling 1970), with g(sigma) from: " + _STATE[3],
}
_QUANTITIES = {
    "Z": _Quantity("compressibility_factor", (), "compressibility factor PV/(N k_B T)", _STATE),
    "contact_value": _Quantity("contact_value", (), "pair distribution at contact g(sigma)", _RATE),
    "mean_free_path": _Quantity("mean_free_path", ("diameter",), "mean free path", _RATE),
    "collision_rate": _Quantity("collision_rate", _PARTICLE, "collisions per particle and time", _RATE),
    "diffusion_coefficient": _Quantity("enskog_diffusion", _PARTICLE, "self-diffusion coefficient", _ENSKOG),
    "viscosity": _Quantity("enskog_viscosity", _PARTICLE, "shear viscosity", _ENSKOG),
}
_EXAMPLES = """examples:
  gaspart theory Z --eta 0.3
  gaspart theory collision_rate --eta 0.1,0.2,0.3 --dimension 2 --diameter 0.1"""


def add_theory(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    names = "; ".join(f"{name}: {quantity.meaning}" for name, quantity in _QUANTITIES.items())
    text = f"{names}. Units: k_B = 1."
    set_command(parser, _theory, text, _EXAMPLES)
    add = parser.add_argument
    add("quantity", choices=tuple(_QUANTITIES), metavar="QUANTITY", help=", ".join(_QUANTITIES))
    add("--eta", type=several(real(least=0.0)), required=True, metavar="X[,X...]", help="packing fraction")
    add("--dimension", type=int, choices=(2, 3), default=3, help="default: 3")
    for name in _PARTICLE:
        add(f"--{name}", type=real(above=0.0), help="default: 1")


def _theory(given: argparse.Namespace) -> None:
    from gaspart import theory

    quantity, dimension = _QUANTITIES[given.quantity], given.dimension
    properties = {key: getattr(given, key) for key in _PARTICLE}
    properties = {key: value for key, value in properties.items() if value is not None}
    for key in properties:
        if key not in quantity.takes:
            raise SceneError(key, properties[key], f"{given.quantity} does not depend on it")
    for eta in given.eta:
        spread = theory.compressibility_uncertainty(eta, dimension)  # first: it refuses any other eta
        value = getattr(theory, quantity.function)(eta, dimension, **properties)
        about = f" +- {float(spread):.1g}" if given.quantity == "Z" else ""
        print(f"{given.quantity}(eta = {eta:g}, dimension = {dimension}) = {float(value):.10g}{about}")
    highest = theory.HIGHEST_PACKING_FRACTION[dimension]
    print(f"{quantity.meaning}, {quantity.source[dimension]}")
    print(f"holds for eta from 0 to {highest:g}, {_FLUID[dimension]}")
