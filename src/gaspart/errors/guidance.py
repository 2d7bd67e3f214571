"""Error messages for mistakes in Python code, each a line that names the remedy.

Such mistakes are calls with wrong arguments, names that do not exist, and changes of constant objects. The
decorator `with_guidance` adds these messages to public classes; `gaspart.public.attach` adds them to public
functions. For files and command lines, `unknown_word` gives the same remedies.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import FrozenInstanceError, is_dataclass
from functools import wraps
from inspect import Parameter, signature
from types import FunctionType, ModuleType
from typing import Any, TypeVar

from gaspart.errors import OneLine, SceneError, unknown_word
from gaspart.errors.synonyms import ELSEWHERE

_NAMED = (Parameter.POSITIONAL_OR_KEYWORD, Parameter.KEYWORD_ONLY)
T = TypeVar("T")


class MissingName(OneLine, AttributeError):
    """Error for a name that an owner lacks, with the name that was probably meant."""

    def __init__(self, owner: ModuleType | type, name: str, names: Iterable[str] = ()) -> None:
        super().__init__(name)
        self._owner, self._name, self._names = owner, name, tuple(names)

    def __reduce__(self) -> tuple:
        return (AttributeError, (str(self),))

    def __str__(self) -> str:  # most of these errors are never shown (hasattr)
        name = repr(self._owner.__name__)
        kind = f"module {name}" if isinstance(self._owner, ModuleType) else f"{name} object"
        message = f"{kind} has no attribute {self._name!r}"
        remedy = _remedy(self._owner, self._name, self._names)
        return f"{message}; {remedy}" if remedy else message


class FixedValue(OneLine, FrozenInstanceError):
    """Error for an attempt to change a constant object."""

    def __init__(self, owner: type, name: str) -> None:
        replacement = f"dataclasses.replace({owner.__name__.lower()}, {name}=...)"
        super().__init__(f"{name} of a {owner.__name__} cannot change; make another one: {replacement}")

    def __reduce__(self) -> tuple:
        return (FrozenInstanceError, self.args)


def _remedy(owner: ModuleType | type, name: str, names: tuple[str, ...]) -> str:
    """Return the name that was probably meant, or "" if no known name is similar.

    names : names of variables of the owner, which have precedence over other attributes
    """
    from difflib import get_close_matches

    remedies = ELSEWHERE.get(owner.__name__.rpartition(".")[2], {})
    if name in remedies:
        return remedies[name]
    for part, inner in _parts(owner):
        if name in dir(inner) or name in getattr(inner, "__annotations__", ()):
            return f"it is {part}.{name}"
    candidates = [
        candidate
        for candidate in {*dir(owner), *getattr(owner, "__annotations__", ())}
        if not candidate.startswith("_")
    ]
    near = get_close_matches(name, [*names, *remedies], n=1) if names else []
    if near and near[0] in remedies:
        return remedies[near[0]]
    near = near or get_close_matches(name, sorted(candidates), n=1)
    return f"did you mean {near[0]}?" if near else ""


def _parts(owner: ModuleType | type) -> Iterable[tuple[str, ModuleType | type]]:
    """Return the parts of an owner, with their names, in which a name is searched, too.

    The parts are subpackages, and attributes whose type is a public class.
    """
    if isinstance(owner, ModuleType):
        within = ((f"{owner.__name__}.{name}", getattr(owner, name)) for name in ("analysis", "theory"))
        return within if owner.__name__ == "gaspart" else ()
    public = sys.modules["gaspart"]
    stated = {
        name: member.fget.__annotations__.get("return")
        for name, member in vars(owner).items()
        if isinstance(member, property) and member.fget
    }
    stated |= getattr(owner, "__annotations__", {})
    classes = {name: getattr(public, str(kind)) for name, kind in stated.items() if str(kind) in dir(public)}
    return classes.items()


def with_guidance(cls: type[T]) -> type[T]:
    """Decorate a public class, so that its errors for mistakes name a remedy."""
    kind: Any = cls  # a type checker must see the methods unchanged
    for name, member in list(vars(cls).items()):
        title = f"{cls.__name__}.{name}"
        if isinstance(member, FunctionType) and not name.startswith("_"):
            setattr(kind, name, with_call_checks(member, title))
        elif isinstance(member, classmethod) and not name.startswith("_"):
            setattr(kind, name, classmethod(with_call_checks(member.__func__, title)))
    if isinstance(kind.__init__, FunctionType):
        kind.__init__ = with_call_checks(kind.__init__, cls.__name__)
    before = getattr(cls, "__getattr__", None)

    def missing(instance: Any, name: str) -> Any:
        if before is not None:
            with suppress(AttributeError):
                return before(instance, name)
        raise MissingName(type(instance), name)

    def refuse_change(instance: Any, name: str, value: Any) -> None:
        raise FixedValue(type(instance), name)

    kind.__getattr__ = missing
    if is_dataclass(cls) and kind.__dataclass_params__.frozen:
        kind.__setattr__ = refuse_change
    return cls


def with_call_checks(function: Callable, title: str) -> Callable:
    """Return a function that raises SceneError instead of TypeError for wrong arguments."""

    @wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        try:
            return function(*arguments, **named)
        except TypeError:
            if (mistake := _mistake(function, title, arguments, named)) is None:
                raise
            raise mistake from None

    return call


def _mistake(function: Callable, title: str, arguments: tuple, named: dict[str, Any]) -> SceneError | None:
    """Return the error that describes a mistake in the arguments of a call.

    If the arguments are correct, None is returned, because the error then comes from the function itself.
    """
    form = signature(function)
    try:
        form.bind(*arguments, **named)
        return None
    except TypeError:
        pass
    parameters = {
        name: parameter for name, parameter in form.parameters.items() if name not in ("self", "cls")
    }
    accepted = [name for name, parameter in parameters.items() if parameter.kind in _NAMED]
    for name, value in named.items():
        if name not in parameters:
            return SceneError(name, value, unknown_word(name, accepted, f"argument of {title}"))
    first = [name for name in accepted if parameters[name].kind is not Parameter.KEYWORD_ONLY]
    shift = len(form.parameters) - len(parameters)
    for name, value in named.items():
        if name in first[: len(arguments) - shift]:
            return SceneError(name, value, f"is given twice to {title}")
    if len(arguments) - shift > len(first):
        rest = [name for name in accepted if name not in first]
        rule = f"is one argument too many: {title} takes {', '.join(first) or 'nothing'} by position"
        rule += f", and by name {', '.join(rest)}" if rest else ""
        return SceneError(f"argument {len(first) + 1}", arguments[len(first) + shift], rule)
    absent = first[len(arguments) - shift :] + [name for name in accepted if name not in first]
    for name in absent:
        if name not in named and parameters[name].default is Parameter.empty:
            return SceneError(name, None, f"is required by {title}")
    return None
