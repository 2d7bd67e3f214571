"""Entries of named tuples that are used by a function that only kernels call.

numba compiles a function again for each combination of argument types, and the type of a `Model` depends on
all features of a scene. Most functions use only a few entries. They are compiled for a tuple whose other
entries have the type None. Then scenes that differ only in unused entries share the compiled functions, and
calls pass less data.

The used entries are found in the source, including entries used by called functions that receive the tuple.
numba omits a branch that compares an argument of type None with None; this module omits such branches, too.
An
argument that is used in any other way than through its entries is passed completely.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from gaspart.kernels.compile.cache import load_numba

numba: Any = load_numba()
types: Any = numba.types

_UNKNOWN = None  # type of any expression that is not an argument or an entry of an argument
_MATTER = types.NamedTuple, types.NoneType
Use = dict  # uses of an entry by name; {} if the entry is only compared with None
WHOLE: Use = {"*": {}}


def narrow_types(function: Callable, arguments: tuple) -> tuple:
    """Return the types of arguments for which a function is compiled instead of the actual types."""
    uses = zip(arguments, _uses(function, arguments), strict=True)
    return tuple(_narrow(argument, use) for argument, use in uses)


class Narrowed(types.NamedTuple):
    """Type of a named tuple that is passed to a function that only kernels call. Entries that the function
    does not use have type None. The type is a class of gaspart, so that the type of numba does not change.
    """

    def __init__(self, kinds: list, instance_class: type) -> None:
        super().__init__(kinds, instance_class)
        # in loops with threads, numba takes the text before the parenthesis as the class name
        self.name = self.name.replace("(", "(narrowed: ", 1)  # type: ignore[has-type]

    def unify(self, context: Any, other: Any) -> Any:
        """Return the common type of this tuple and of a tuple made by the function."""
        if not isinstance(other, types.NamedTuple) or other.instance_class is not self.instance_class:
            return None
        kinds = [context.unify_pairs(*pair) for pair in zip(self.types, other.types, strict=True)]
        return None if None in kinds else types.NamedTuple(kinds, self.instance_class)


def _narrow(full_type: Any, use: Use) -> Any:
    if not isinstance(full_type, types.NamedTuple):
        return full_type
    key = full_type._code, str(use)
    if key not in _known_types:
        entries = zip(full_type.fields, full_type.types, strict=True)
        if "*" in use:
            kept = full_type.types
        else:
            kept = [_narrow(kind, use[name]) if name in use else types.none for name, kind in entries]
        _known_types[key] = Narrowed(kept, full_type.instance_class)
    return _known_types[key]


@numba.extending.lower_cast(types.NamedTuple, Narrowed)
@numba.extending.lower_cast(Narrowed, Narrowed)
@numba.extending.lower_cast(Narrowed, types.NamedTuple)
def _leave_out(context: Any, builder: Any, full_type: Any, narrow: Any, value: Any) -> Any:
    """Build a tuple with the entries that a function uses."""
    none = context.get_dummy_value()
    entries = numba.core.cgutils.unpack_tuple(builder, value, len(full_type))
    kept = [
        none if kind == types.none else context.cast(builder, entry, entry_type, kind)
        for entry, entry_type, kind in zip(entries, full_type, narrow, strict=True)
    ]
    return context.make_tuple(builder, narrow, kept)


@numba.extending.register_model(Narrowed)
class _OneArgument(numba.extending.models.TupleModel):
    """Data model that passes a narrowed tuple as a single argument in machine code. numba passes a named
    tuple as one argument per machine word of its arrays. A `Model` has about two hundred words. Each call
    unpacks them, and each function packs them again, which amounts to 40 % of all instructions to be
    translated.
    """

    def get_argument_type(self) -> Any:
        """Return the LLVM type of the argument."""
        return self.get_value_type()

    def as_argument(self, builder: Any, value: Any) -> Any:
        """Return the value that a caller passes."""
        return value

    def from_argument(self, builder: Any, value: Any) -> Any:
        """Return the value of a passed argument."""
        return value


def _uses(function: Callable, arguments: tuple) -> tuple[Use, ...]:
    """Return the entries of each argument that a function uses, for given types; `_UNKNOWN` if
    undetermined.
    """
    key = _key(function, arguments)
    if key not in _known_uses:
        _known_uses[key] = _read(function, arguments)
    return _known_uses[key]


def _key(function: Callable, arguments: tuple) -> tuple:
    """Return a key of a function and its argument types; hashing the types themselves is slow."""
    numbers = (kind._code if isinstance(kind, _MATTER) else _UNKNOWN for kind in arguments)
    return function.__code__, tuple(numbers)


_known_uses: dict[tuple, tuple[Use, ...]] = {}
_known_types: dict[tuple[int, str], Any] = {}


def _read(function: Callable, arguments: tuple) -> tuple[Use, ...]:
    definition, assigned = _definition(function.__code__)
    if definition is None or len(definition.args.args) != len(arguments):
        return tuple(WHOLE for _ in arguments)
    names = [argument.arg for argument in definition.args.args]
    kinds = dict(zip(names, arguments, strict=True)) | dict.fromkeys(assigned, _UNKNOWN)
    reader = _Reader(function.__globals__, kinds)
    reader.block(definition.body)
    return tuple(reader.uses[name] for name in names)


@cache
def _definition(code: Any) -> tuple[ast.FunctionDef | None, set[str]]:
    """Return the source of a module's function and the arguments that it assigns; None for any other."""
    try:
        definition = _functions(code.co_filename).get(code.co_firstlineno)
    except OSError:
        definition = None
    if definition is None or definition.name != code.co_qualname or not _is_plain(definition.args):
        return None, set()
    names = [node for node in ast.walk(definition) if isinstance(node, ast.Name)]
    own = {argument.arg for argument in definition.args.args}
    return definition, {node.id for node in names if isinstance(node.ctx, ast.Store)} & own


@cache
def _functions(file: str) -> dict[int, ast.FunctionDef]:
    """Return the functions of a module, by the first line of their code."""
    functions = [
        node for node in ast.parse(Path(file).read_bytes()).body if isinstance(node, ast.FunctionDef)
    ]
    return {
        min([node.lineno, *(before.lineno for before in node.decorator_list)]): node for node in functions
    }


def _is_plain(arguments: ast.arguments) -> bool:
    """Return True if all arguments are positional and have no default, as those that numba passes here."""
    others = arguments.posonlyargs, arguments.kwonlyargs, arguments.defaults
    return not any(others) and arguments.vararg is None and arguments.kwarg is None


def _merge(target: Use, other: Use) -> None:
    for name, use in other.items():
        _merge(target.setdefault(name, {}), use)


class _Reader(ast.NodeVisitor):
    """Syntax-tree visitor that records how a function uses its arguments."""

    def __init__(self, names: dict[str, Any], arguments: dict[str, Any]) -> None:
        self.names, self.arguments = names, arguments
        self.uses: dict[str, Use] = {name: {} for name in arguments}

    def block(self, statements: list[ast.stmt]) -> bool:
        """Visit statements; return True if they always end the function."""
        for statement in statements:
            if isinstance(statement, ast.If):
                if self._branch(statement):
                    return True
            else:
                self.visit(statement)
                if isinstance(statement, ast.Return | ast.Raise):
                    return True
        return False

    def _branch(self, branch: ast.If) -> bool:
        """Visit the compiled part of a branch; return True if it always ends the function."""
        match branch.test:
            case ast.Compare(ast.Name(name), [ast.Is() | ast.IsNot() as sign], [ast.Constant(None)]):
                if isinstance(self.arguments.get(name), types.NoneType):
                    return self.block(branch.body if isinstance(sign, ast.Is) else branch.orelse)
            case _:
                self.visit(branch.test)
        ends = self.block(branch.body), self.block(branch.orelse)
        return all(ends)

    def visit_Name(self, node: ast.Name) -> None:
        """Record an argument that is used as a whole."""
        if node.id in self.uses:
            _merge(self.uses[node.id], WHOLE)

    def visit_Attribute(self, node: ast.Attribute) -> None:
        """Record the use of an entry, or of an entry of an entry."""
        path = self._path(node)
        if path is None:
            self.generic_visit(node)
        else:
            self._note(path, WHOLE)

    def visit_For(self, node: ast.For) -> None:
        """Visit the body as a block."""
        self.visit(node.target)
        self.visit(node.iter)
        self.block(node.body)
        self.block(node.orelse)

    def visit_While(self, node: ast.While) -> None:
        """Visit the body as a block."""
        self.visit(node.test)
        self.block(node.body)
        self.block(node.orelse)

    def visit_Call(self, node: ast.Call) -> None:
        """Record the uses of arguments in a called function of gaspart."""
        called = self.names.get(node.func.id) if isinstance(node.func, ast.Name) else None
        function = getattr(called, "py_func", None)
        kinds = tuple(map(self._type, node.args))
        named = any(isinstance(kind, types.NamedTuple) for kind in kinds)  # others receive all
        starred = any(isinstance(item, ast.Starred) for item in node.args)
        if function is None or not named or node.keywords or starred:
            self.generic_visit(node)
            return
        uses = _uses(function, kinds)
        for argument, use in zip(node.args, uses, strict=True):
            path = self._path(argument)
            if path is None:
                self.visit(argument)
            else:
                self._note(path, use)

    def _note(self, path: list[str], use: Use) -> None:
        """Record a use of an argument or of an entry."""
        at = self.uses[path[0]]
        for name in path[1:]:
            at = at.setdefault(name, {})
        _merge(at, use)

    def _path(self, node: ast.expr) -> list[str] | None:
        """Return the argument and the entries that an expression selects; None for any other expression."""
        match node:
            case ast.Name(name) if name in self.uses:
                return [name]
            case ast.Attribute(value, name):
                outer = self._path(value)
                kind = self._type(value)
                if outer is None or not isinstance(kind, types.NamedTuple) or name not in kind.fields:
                    return None
                return [*outer, name]
        return None

    def _type(self, node: ast.expr) -> Any:
        """Return the type of an argument, of an entry of an argument, or of None."""
        match node:
            case ast.Constant(None):
                return types.none
            case ast.Name(name):
                return self.arguments.get(name, _UNKNOWN)
            case ast.Attribute(value, name):
                kind = self._type(value)
                if isinstance(kind, types.NamedTuple) and name in kind.fields:
                    return kind.types[kind.fields.index(name)]
        return _UNKNOWN
