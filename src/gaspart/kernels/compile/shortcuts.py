"""What numba works out again for every function that it compiles, although the answer is known.

None of this changes what is compiled; together it is a sixth of the time of a first run. numba compares the
options of a function by a new list of all thirty; it resolves every addition of two numbers by asking some
hundred rules; it looks ten times for the variables that live in each block, and uses the last answer; and
each function that is being compiled times every lock of those that it calls.
"""

from __future__ import annotations

from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

from gaspart.kernels.compile.loading import load_numba

numba: Any = load_numba()
core: Any = numba.core
Options: Any = core.targetconfig.TargetConfig
Function: Any = core.types.functions.BaseFunction
_ask_rules = Function.get_call_type
Processor: Any = core.postproc.PostProcessor
_process_all = Processor.run
_found: dict[tuple, tuple] = {}


def take() -> None:
    """Let numba take the shortcuts, in this process."""
    Options.values, Options.__eq__, Options.__hash__ = _values, _equal, _hash
    Function.get_call_type = _resolve
    core.dispatcher.ev = SimpleNamespace(trigger_event=core.event.trigger_event, install_timer=_no_timer)
    core.codegen.ll.ffi.lib._lock._cblist.clear()  # of the same timers
    core.ir.Inst._rec_list_vars = _variables
    Processor.run = _process


def _values(options: Any) -> dict[str, Any]:
    """The options by name."""
    return {name: option.default for name, option in options.options.items()} | options._values


def _equal(one: Any, other: Any) -> Any:
    if not isinstance(other, Options):
        return NotImplemented
    return one._values == other._values or one.values() == other.values()


def _hash(options: Any) -> int:
    """That of options which are equal is equal; numba's too differs by their names only."""
    return hash(type(options))


def _resolve(function: Any, context: Any, arguments: tuple, keywords: dict) -> Any:
    """The signature of a call, which follows from the types, known by their numbers, and the options of the
    caller. A call that has none is resolved again, since the error states where it is."""
    if keywords:
        return _ask_rules(function, context, arguments, keywords)
    options = core.targetconfig.ConfigStack.top_or_none()
    key = function._code, id(context), tuple([one._code for one in arguments]), options
    known = _found.get(key)
    if known is None:
        signature = _ask_rules(function, context, arguments, keywords)
        _found[key] = known = signature, function._impl_keys[signature.args]
    signature, implementation = known
    function._impl_keys[signature.args] = implementation
    return signature


def _no_timer(kind: str, callback: Any) -> Any:
    """In place of numba's timers, whose times would be kept with the code and which nothing here reads."""
    return nullcontext()


def _variables(instruction: Any, value: Any) -> list:
    """The variables in a part of an instruction."""
    kind = type(value)
    if kind is core.ir.Var:
        return [value]
    if isinstance(value, core.ir.Inst):
        return list(value.list_vars())
    if kind is dict:
        value = value.values()
    elif kind is not tuple and kind is not list:
        return []
    return [one for part in value for one in _variables(instruction, part)]


def _process(processor: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
    """Bring the blocks of a function in order, and end the lives of its variables if `emit_dels`: which those
    are is found where it is read. What lives at the beginning of a block only generators and uncompiled code
    need."""
    function = processor.func_ir
    if function.is_generator:
        _process_all(processor, emit_dels, extend_lifetimes)
        return
    function.blocks = core.transforms.canonicalize_cfg(function.blocks)
    function.variable_lifetime = core.postproc.VariableLifetime(function.blocks)
    function.generator_info = None
    if emit_dels:
        processor._insert_var_dels(extend_lifetimes=extend_lifetimes)
