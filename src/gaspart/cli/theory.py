"""`gaspart theory`: a value of theory, with its uncertainty, source and range of validity."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from gaspart.analysis.observables import OBSERVABLES
from gaspart.cli.arguments import Parser, list_names, real, set_command, several
from gaspart.errors import SceneError
from gaspart.scene.facts import Gas
from gaspart.theory.mixtures import MIXTURE_THEORIES

_PARTICLE = ("diameter", "temperature", "mass")
_EQUATIONS = ("exact", "boltzmann", "enskog")
_STATE = {
    2: "virial series to B10 with a linear tail (Clisby and McCoy 2006)",
    3: "Kolafa, Labik and Malijevsky 2004",
}
_FLUID = {2: "the fluid of discs", 3: "the fluid of spheres (metastable from 0.4915)"}


@dataclass(frozen=True)
class _Quantity:
    """Quantity with a theoretical value for a `Gas`.

    takes : properties of the particle on which the value depends.
    mixture : function of gaspart.theory for mixtures.
    """

    value: Callable[[Gas, str], float]
    takes: tuple[str, ...]
    meaning: str
    source: str
    mixture: str = ""


def _formula(name: str, takes: tuple[str, ...]) -> Callable[[Gas, str], float]:
    """Return a function of gaspart.theory for touching particles."""

    def value(gas: Gas, equation: str) -> float:
        from gaspart import theory

        if equation != "exact":
            raise SceneError("equation", equation, "must be exact for this quantity")
        properties = {key: gas.particle[key] for key in takes}
        return float(getattr(theory, name)(gas.packing_fraction, gas.dimension, **properties))

    return value


def _observable(name: str) -> Callable[[Gas, str], float]:
    """Return a function of `gaspart.theory.bulk`."""

    def value(gas: Gas, equation: str) -> float:
        from gaspart.theory import bulk

        return float(getattr(bulk, name)(gas, equation))

    return value


_ENSKOG = "Enskog's theory (Chapman and Cowling 1970; discs Gass 1971), with g(sigma) from: {state}"
_RATE = "exact in equilibrium, with g(sigma) from: {state}"
_QUANTITIES = {
    name: _Quantity(
        _observable(observable.bulk),
        _PARTICLE if any(observable.powers(3)) else (),
        observable.definition,
        observable.source,
        observable.mixture,
    )
    for name, observable in OBSERVABLES.items()
    if observable.bulk
}
_QUANTITIES |= {
    "contact_value": _Quantity(
        _formula("contact_value", ()),
        (),
        "pair distribution at contact g(sigma)",
        _RATE,
        "mixture_contact_values",
    ),
    "compressibility": _Quantity(
        _formula("reduced_compressibility", ()), (), "k_B T d(rho)/dP, which is S(0)", "{state}"
    ),
    "mean_free_path": _Quantity(
        _formula("mean_free_path", ("diameter",)), ("diameter",), "mean free path", _RATE
    ),
    "diffusion_coefficient": _Quantity(
        _formula("enskog_diffusion", _PARTICLE), _PARTICLE, "self-diffusion coefficient", _ENSKOG
    ),
    "viscosity": _Quantity(_formula("enskog_viscosity", _PARTICLE), _PARTICLE, "shear viscosity", _ENSKOG),
}
"""Quantities by name: observables with a value in an infinite gas, and formulas."""
_MIXTURE_SOURCES = {
    "boublik": "Boublik 1970, Mansoori and others 1971",
    "linear": "Santos, Yuste and Lopez de Haro 1999",
    "santos": "Santos, Yuste and Lopez de Haro 2002",
}
_EXAMPLES = """examples:
  gaspart theory Z --eta 0.3
  gaspart theory contact_value --eta 0.3 --diameters 1,0.5 --fractions 0.2,0.8
  gaspart theory collision_rate --eta 0.1,0.2,0.3 --dimension 2 --diameter 0.1"""


def add_theory(parser: Parser) -> None:
    """Add the arguments of the command to its parser."""
    set_command(parser, _theory, "A value of theory, with its source. Units: k_B = 1.", _EXAMPLES)
    meanings = {name: quantity.meaning for name, quantity in _QUANTITIES.items()}
    parser.description = f"{parser.description}\n\nquantities:\n{list_names(meanings)}"
    add = parser.add_argument
    add("quantity", choices=tuple(_QUANTITIES), metavar="QUANTITY", help="one of the above")
    add("--eta", type=several(real(least=0.0)), required=True, metavar="X[,X...]", help="packing fraction")
    add("--dimension", type=int, choices=(2, 3), default=3, help="default: 3")
    text = "of particles that touch, or the kinetic equation that the DSMC engine solves; default: exact"
    add(
        "--equation",
        choices=_EQUATIONS,
        default="exact",
        metavar="NAME",
        help=f"{', '.join(_EQUATIONS)}: {text}",
    )
    for name in _PARTICLE:
        add(f"--{name}", type=real(above=0.0), help="default: 1")
    text = "of the species of a mixture, in the place of --diameter"
    add("--diameters", type=several(real(above=0.0)), metavar="X[,X...]", help=text)
    text = "number fractions of the species; default: equal"
    add("--fractions", type=several(real(least=0.0)), metavar="X[,X...]", help=text)
    add("--masses", type=several(real(above=0.0)), metavar="X[,X...]", help="likewise; default: 1")


def _theory(options: argparse.Namespace) -> None:
    from gaspart import theory

    if options.diameters is not None:
        _of_mixture(options)
        return
    for key in ("fractions", "masses"):
        if getattr(options, key) is not None:
            raise SceneError(key, getattr(options, key), "needs the --diameters of a mixture")
    quantity, dimension = _QUANTITIES[options.quantity], options.dimension
    properties = {key: getattr(options, key) for key in _PARTICLE}
    properties = {key: value for key, value in properties.items() if value is not None}
    for key in properties:
        if key not in quantity.takes:
            raise SceneError(key, properties[key], f"{options.quantity} does not depend on it")
    for eta in options.eta:
        # first, because it rejects any other packing fraction eta
        spread = theory.compressibility_uncertainty(eta, dimension)
        gas = Gas(dimension, eta, 1, **{key: properties.get(key, 1.0) for key in _PARTICLE})
        value = quantity.value(gas, options.equation)
        if math.isnan(value):
            raise SceneError(
                "quantity", options.quantity, f"is not known for {_FLUID[dimension]} at eta = {eta:g}"
            )
        about = f" +- {float(spread):.1g}" if options.quantity == "Z" and options.equation == "exact" else ""
        print(f"{options.quantity}(eta = {eta:g}, dimension = {dimension}) = {value:.10g}{about}")
    highest = theory.HIGHEST_PACKING_FRACTION[dimension]
    exact = quantity.source.format(state=_STATE[dimension])
    print(f"{quantity.meaning}, {exact if options.equation == 'exact' else f'{options.equation} equation'}")
    print(f"holds for eta from 0 to {highest:g}, {_FLUID[dimension]}")


def _of_mixture(options: argparse.Namespace) -> None:
    """Print a line for each theory and density. Properties of pairs have a line for each pair of species."""
    from gaspart import theory

    name = _QUANTITIES[options.quantity].mixture
    if not name:
        able = (key for key, quantity in _QUANTITIES.items() if quantity.mixture)
        raise SceneError("quantity", options.quantity, f"is not defined for mixtures; use {', '.join(able)}")
    if options.equation != "exact":
        raise SceneError("equation", options.equation, "must be exact for mixtures")
    takes = ("temperature",) if _QUANTITIES[options.quantity].takes else ()
    properties = {key: getattr(options, key) for key in _PARTICLE if getattr(options, key) is not None}
    for key in properties:
        if key not in takes:
            raise SceneError(key, properties[key], f"{options.quantity} of a mixture does not depend on it")
    if options.masses is not None:
        if not takes:
            raise SceneError("masses", options.masses, f"{options.quantity} does not depend on them")
        properties["masses"] = options.masses
    state = options.dimension, options.diameters, options.fractions
    of_first = ", of a particle of the first of the pair with all of the second"
    for eta in options.eta:
        for kind, dimensions in MIXTURE_THEORIES.items():
            if options.dimension in dimensions:
                value = getattr(theory, name)(eta, *state, theory=kind, **properties)
                state_text = f"eta = {eta:g}, dimension = {options.dimension}"
                print(f"{options.quantity}({state_text}), {kind}: {_pairs(value)}")
    print(f"{_QUANTITIES[options.quantity].meaning}{of_first if takes else ''}")
    print("; ".join(f"{kind}: {source}" for kind, source in _MIXTURE_SOURCES.items()))
    highest = theory.HIGHEST_PACKING_FRACTION[options.dimension]
    print(f"approximations, for eta from 0 to {highest:g}; their differences are a measure of their errors")


def _pairs(value: Any) -> str:
    """Format a number, or the numbers of all pairs of species, which count from 0."""
    if np.ndim(value) == 0:
        return f"{float(value):.8g}"
    return ", ".join(f"{i}-{j} {number:.8g}" for (i, j), number in np.ndenumerate(value))
