"""`gaspart theory`: a number that theory says, how sure it is, and where it is from."""

from __future__ import annotations

import argparse

from gaspart.cli.arguments import UsageError, several
from gaspart.errors import SceneError

# `gaspart theory`: name -> (function of gaspart.theory, the body's properties it takes, what it is)
_BODY = ("diameter", "temperature", "mass")
_QUANTITIES = {
    "Z": ("compressibility_factor", (), "compressibility factor PV/(N k_B T), best reference"),
    "contact_value": ("contact_value", (), "pair distribution at contact g(sigma)"),
    "mean_free_path": ("mean_free_path", ("diameter",), "mean free path"),
    "collision_rate": ("collision_rate", _BODY, "collisions per body and time"),
    "diffusion_coefficient": ("enskog_diffusion", _BODY, "self-diffusion coefficient of Enskog's theory"),
    "viscosity": ("enskog_viscosity", _BODY, "shear viscosity of Enskog's theory"),
}


def add_theory(commands) -> None:
    names = "; ".join(f"{name}: {meaning}" for name, (_, _, meaning) in _QUANTITIES.items())
    theory = commands.add_parser("theory", help="what theory says", description=f"{names}. Units: k_B = 1.")
    theory.set_defaults(command=_theory)
    theory.add_argument("quantity", choices=_QUANTITIES, metavar="QUANTITY", help=", ".join(_QUANTITIES))
    theory.add_argument(
        "--eta", type=several(float), required=True, metavar="X[,X...]", help="packing fraction"
    )
    theory.add_argument("--dimension", type=int, choices=(2, 3), required=True)
    for name in _BODY:
        theory.add_argument(f"--{name}", type=float, help="default: 1")


def _theory(given: argparse.Namespace) -> None:
    from gaspart import theory

    function, takes, _ = _QUANTITIES[given.quantity]
    properties = {key: getattr(given, key) for key in _BODY}
    properties = {key: value for key, value in properties.items() if value is not None}
    for key in properties:
        if key not in takes:
            raise SceneError(key, properties[key], f"{given.quantity} does not depend on it")
    for eta in given.eta:
        try:
            value = getattr(theory, function)(eta, given.dimension, **properties)
            spread = theory.compressibility_uncertainty(eta, given.dimension)
        except ValueError as error:
            raise UsageError(error) from None
        error = f" +- {float(spread):.1g}" if given.quantity == "Z" else ""
        print(f"{given.quantity}(eta = {eta:g}, dimension = {given.dimension}) = {float(value):.10g}{error}")
