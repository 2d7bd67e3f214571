"""Units as text: what power of the units of length, mass and time a quantity has."""

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Powers:
    """Those of mass, length and time."""

    mass: float = 0.0
    length: float = 0.0
    time: float = 0.0

    def __mul__(self, other):
        return Powers(self.mass + other.mass, self.length + other.length, self.time + other.time)

    def __pow__(self, power):
        return Powers(power * self.mass, power * self.length, power * self.time)

    def scale(self, mass, length, time):
        """The number of a quantity in other units, over that in these: units in which one of the old length
        is `length` new ones, and likewise."""
        return mass**self.mass * length**self.length * time**self.time


_NAMES = {"1": Powers(), "mass": Powers(mass=1), "length": Powers(length=1), "time": Powers(time=1)}
_NAMES["energy"] = Powers(1, 2, -2)
_NAMES["degree"] = Powers()
_TOKEN = re.compile(r"\s*([a-z]+|1(?![\d.])|[()/]|\^(?:-?[\d.]+|d\b))")


def powers_of(text, dimension):
    """The powers of units such as `mass / (length^2 time)`; a product is of words, and what stands behind a
    bar up to the end of its bracket divides. Raises KeyError and ValueError for other texts."""
    text = re.sub(r"\((\d)-d\)", lambda power: str(int(power[1]) - dimension), text)
    tokens, at = [], 0
    while at < len(text.rstrip()):
        found = _TOKEN.match(text, at)
        if not found:
            raise ValueError(f"units: {text!r}")
        tokens.append(found[1])
        at = found.end()
    powers, rest = _product(tokens, dimension)
    if rest:
        raise ValueError(f"units: {text!r}")
    return powers


def _product(tokens, dimension):
    """The powers of the tokens up to a closing bracket, and the tokens from there on."""
    total, sign = Powers(), 1
    while tokens and tokens[0] != ")":
        if tokens[0] == "/":
            sign, tokens = -1, tokens[1:]
            continue
        if tokens[0] == "(":
            one, tokens = _product(tokens[1:], dimension)
            tokens = tokens[1:]
        else:
            one, tokens = _NAMES[tokens[0]], tokens[1:]
        if tokens and tokens[0][0] == "^":
            exponent = tokens[0][1:]
            one, tokens = one ** (dimension if exponent == "d" else float(exponent)), tokens[1:]
        total = total * one**sign
    return total, tokens
