"""Kernels as WebAssembly modules, which give the same bits as native code.

numba translates kernels to LLVM IR, and the WebAssembly target of llvmlite compiles it. An object file
without undefined functions is a module already; only its exports are added, so no linker is needed. The
translation runs in a process of its own without optimisation for this processor (NUMBA_OPT=0), because
optimised code depends on the size of pointers.

A kernel becomes a function of three addresses: its arguments in words of eight bytes, its result and its
error.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding as llvm

from gaspart.files import scratch_beside
from gaspart.kernels import simd
from gaspart.kernels.compile.cache import load_numba, shipped_content, usable_cache
from gaspart.kernels.compile.policy import inner_kernel
from gaspart.kernels.compile.sources import closure_digests

Kernels = dict[str, tuple[str, str, tuple]]
"""Functions of a module by their names: the Python module, the name there, and the types of the arguments."""

_TRIPLE = "wasm32-unknown-unknown"
_FEATURES = "+bulk-memory,+bulk-memory-opt,+nontrapping-fptoint,+sign-ext,+mutable-globals,+simd128"
_HELPERS = """
define double @numba_frexp(double %x, ptr %exponent) {
  %size = call double @llvm.fabs.f64(double %x)
  %subnormal = fcmp olt double %size, 0x0010000000000000
  %scaled = fmul double %x, 0x4350000000000000
  %y = select i1 %subnormal, double %scaled, double %x
  %bias = select i1 %subnormal, i32 1076, i32 1022
  %bits = bitcast double %y to i64
  %shifted = lshr i64 %bits, 52
  %field = and i64 %shifted, 2047
  %zero = fcmp oeq double %x, 0.0
  %infinite = icmp eq i64 %field, 2047
  %same = or i1 %zero, %infinite
  %biased = trunc i64 %field to i32
  %power = sub i32 %biased, %bias
  %e = select i1 %same, i32 0, i32 %power
  store i32 %e, ptr %exponent
  %cleared = and i64 %bits, -9218868437227405313
  %set = or i64 %cleared, 4602678819172646912
  %mantissa = bitcast i64 %set to double
  %m = select i1 %same, double %x, double %mantissa
  ret double %m
}
declare double @llvm.fabs.f64(double)
define void @__multi3(ptr %out, i64 %a, i64 %a_up, i64 %b, i64 %b_up) {
  %al = and i64 %a, 4294967295
  %ah = lshr i64 %a, 32
  %bl = and i64 %b, 4294967295
  %bh = lshr i64 %b, 32
  %ll = mul i64 %al, %bl
  %hl = mul i64 %ah, %bl
  %lh = mul i64 %al, %bh
  %hh = mul i64 %ah, %bh
  %carry = lshr i64 %ll, 32
  %middle = add i64 %hl, %carry
  %middle_low = and i64 %middle, 4294967295
  %other = add i64 %lh, %middle_low
  %m1 = lshr i64 %middle, 32
  %m2 = lshr i64 %other, 32
  %h1 = add i64 %hh, %m1
  %h2 = add i64 %h1, %m2
  %c1 = mul i64 %a, %b_up
  %c2 = mul i64 %a_up, %b
  %h3 = add i64 %h2, %c1
  %h4 = add i64 %h3, %c2
  %low = mul i64 %a, %b
  store i64 %low, ptr %out
  %up = getelementptr i64, ptr %out, i32 1
  store i64 %h4, ptr %up
  ret void
}
"""
"""Functions of the run-time library that kernels call: frexp, and the product of 128 bits."""


def modules(kinds: list[Kernels]) -> list[bytes]:
    """Return the WebAssembly module of each kind of kernels, if possible from the cache."""
    names = [f"wasm/{_key(kernels)}.wasm" for kernels in kinds]
    cache = usable_cache("wasm")
    paths = [cache.parent / name if cache else None for name in names]
    codes = [
        shipped_content(name) or (path.read_bytes() if path and path.is_file() else None)
        for name, path in zip(names, paths, strict=True)
    ]
    missing = [n for n, code in enumerate(codes) if code is None]
    if missing:
        for n, code in zip(missing, _build([kinds[n] for n in missing]), strict=True):
            codes[n] = code
            if path := paths[n]:
                with scratch_beside(path) as scratch:
                    scratch.write_bytes(code)
                    scratch.replace(path)
    return [code for code in codes if code is not None]


def _key(kernels: Kernels) -> str:
    """Return a hash of all on which the bytes of a module depend."""
    described = sorted((name, *function[:2], str(function[2])) for name, function in kernels.items())
    digests = closure_digests()
    sources = [
        digests[str(import_module(name).__file__)] for name in (__name__, *(row[1] for row in described))
    ]
    versions = load_numba().__version__, llvmlite.__version__, sources
    return hashlib.sha256(repr((described, versions)).encode()).hexdigest()[:32]


def _build(kinds: list[Kernels]) -> list[bytes]:
    """Compile modules in another process, because translations of this process are optimised for it."""
    with tempfile.TemporaryDirectory() as folder:
        values, result = Path(folder) / "kinds", Path(folder) / "modules"
        values.write_bytes(pickle.dumps(kinds))
        environment = os.environ | {
            "NUMBA_OPT": "0",
            "GASPART_CACHE": f"{folder}/cache",
            "PYTHONWARNINGS": "ignore",
        }
        command = [sys.executable, "-m", __name__, str(values), str(result)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"kernels cannot be compiled to WebAssembly:\n{done.stderr}")
        return pickle.loads(result.read_bytes())


def _compile(kernels: Kernels) -> bytes:
    """Compile one module."""
    linked = llvm.parse_assembly("")
    for name, (path, function, types) in kernels.items():
        part = inner_kernel(getattr(import_module(path), function).py_func)
        part.compile(types)
        result = part.overloads[types]
        translated = llvm.parse_bitcode(result.library._final_module.as_bitcode())
        _add_entry(translated, result.fndesc.llvm_func_name, name)
        linked.link_in(translated)
    for item in (*linked.functions, *linked.global_variables):
        if not item.is_declaration and item.name not in kernels:
            item.linkage = "internal"
    target = llvm.Target.from_triple(_TRIPLE)
    machine = target.create_target_machine(opt=3, features=_FEATURES, reloc="static", codemodel="default")
    linked.triple, linked.data_layout = _TRIPLE, str(machine.target_data)
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
    builder.getModulePassManager().run(linked, builder)
    # after the optimisation, which would recognise the product of 128 bits and call it
    linked.link_in(llvm.parse_assembly(_HELPERS))
    for name in ("numba_frexp", "__multi3"):
        linked.get_function(name).linkage = "internal"
    return _with_exports(machine.emit_object(linked), list(kernels))


def _add_entry(module: Any, function: str, name: str) -> None:
    """Add a function that loads the arguments of another function from words of eight bytes."""
    kinds = [str(argument.type) for argument in module.get_function(function).arguments][2:]
    lines = [f'declare i32 @"{function}"(ptr, ptr, {", ".join(kinds)})']
    lines += [f"define i32 @{name}(ptr %words, ptr %out, ptr %error) {{"]
    for k, kind in enumerate(kinds):
        lines += [
            f"  %p{k} = getelementptr i64, ptr %words, i64 {k}",
            f"  %a{k} = load {kind}, ptr %p{k}, align 8",
        ]
    values = ", ".join(f"{kind} %a{k}" for k, kind in enumerate(kinds))
    lines += [f'  %r = call i32 @"{function}"(ptr %out, ptr %error, {values})', "  ret i32 %r", "}"]
    module.link_in(llvm.parse_assembly("\n".join(lines)))


# Binary format: https://webassembly.github.io/spec/core/binary, and for the section "linking"
# https://github.com/WebAssembly/tool-conventions/blob/main/Linking.md

_EXPORT, _AFTER_EXPORTS = 7, (8, 9, 10, 11, 12)
_SYMBOL_TABLE, _UNDEFINED, _EXPLICIT_NAME = 8, 0x10, 0x40
_FUNCTION, _DATA, _SECTION = 0, 1, 3


def _leb(number: int) -> bytes:
    coded = b""
    while True:
        coded += bytes([(number & 127) | (128 if number > 127 else 0)])
        number >>= 7
        if not number:
            return coded


def _read(code: bytes, at: int) -> tuple[int, int]:
    """Return the number at a path of the code, and the path after it."""
    number = shift = 0
    while True:
        byte = code[at]
        number |= (byte & 127) << shift
        at, shift = at + 1, shift + 7
        if byte < 128:
            return number, at


def _sections(code: bytes, at: int) -> Iterator[tuple[int, bytes]]:
    while at < len(code):
        size, start = _read(code, at + 1)
        yield code[at], code[start : start + size]
        at = start + size


def _function_numbers(code: bytes) -> dict[str, int]:
    """Return the number of each function that is defined in an object file, by its name."""
    numbers: dict[str, int] = {}
    (linking,) = (body for kind, body in _sections(code, 8) if kind == 0 and body.startswith(b"\x07linking"))
    (table,) = (body for kind, body in _sections(linking, 9) if kind == _SYMBOL_TABLE)
    count, at = _read(table, 0)
    for _ in range(count):
        kind = table[at]
        flags, at = _read(table, at + 1)
        defined = not flags & _UNDEFINED
        if kind == _SECTION:
            _, at = _read(table, at)
        elif kind == _DATA:
            size, at = _read(table, at)
            at += size
            for _ in range(3 * defined):
                _, at = _read(table, at)
        else:
            number, at = _read(table, at)
            if defined or flags & _EXPLICIT_NAME:
                size, at = _read(table, at)
                if kind == _FUNCTION and defined:
                    numbers[table[at : at + size].decode()] = number
                at += size
    return numbers


def _with_exports(code: bytes, names: list[str]) -> bytes:
    """Convert an object file to a module that exports functions; data for a linker are omitted."""
    numbers = _function_numbers(code)
    exports = _leb(len(names))
    for name in names:
        exports += _leb(len(name)) + name.encode() + bytes([_FUNCTION]) + _leb(numbers[name])
    sections = [(kind, body) for kind, body in _sections(code, 8) if kind]
    path = next(n for n, (kind, _) in enumerate(sections) if kind in _AFTER_EXPORTS)
    sections.insert(path, (_EXPORT, exports))
    return code[:8] + b"".join(bytes([kind]) + _leb(len(body)) + body for kind, body in sections)


if __name__ == "__main__":
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    # a vector of WebAssembly has two numbers; eight need more registers than there are (times 1.3)
    simd.WIDTH = 2
    source, answer = map(Path, sys.argv[1:])
    answer.write_bytes(pickle.dumps([_compile(kernels) for kernels in pickle.loads(source.read_bytes())]))
