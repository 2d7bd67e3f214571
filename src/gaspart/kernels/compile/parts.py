"""How functions are compiled that only kernels call.

numba optimises every function and makes machine code of it, and optimises it again within each function that
calls it, up to the kernel that Python calls. These are only translated, and left to the last: what runs is
that one, and the others would be most of the time that a first run takes. Their translations are kept in
files, for other kernels that call them: most do not depend on what a scene requires.
"""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, ClassVar

from gaspart.kernels.compile.cache import load_numba
from gaspart.kernels.compile.files import KernelCache, KernelContents
from gaspart.kernels.compile.narrowing import narrowed

numba: Any = load_numba()
core: Any = numba.core

_FIRST = 2**32  # of the numbers below; numba counts from 1
_numbers = itertools.count(_FIRST + int.from_bytes(os.urandom(7), "big"))


@contextmanager
def _own_numbers() -> Iterator[None]:
    """Number what is compiled meanwhile, functions of numba included, as no other process does.

    numba numbers the functions of a process, to give those of one name different names in machine code. What
    several processes have translated meets in one kernel, so that no two of them may count from one number.
    """
    identity = core.bytecode.FunctionIdentity
    before, identity._unique_ids = identity._unique_ids, _numbers
    try:
        yield
    finally:
        identity._unique_ids = before


def narrow_calls(part: Any) -> None:
    """Let the callers of a function compile it for what it uses of their arguments."""

    def get_call_template(arguments: tuple, keywords: dict) -> tuple:
        signature, arguments = part._compiler.fold_argument_types(arguments, keywords)
        used = narrowed(part.py_func, tuple(arguments))
        template, *_ = type(part).get_call_template(part, used, {})
        return template, signature, used, {}

    part.get_call_template = get_call_template


class _PartLibrary(core.codegen.JITCodeLibrary):
    """Code that is linked into that of the callers, and only there fully optimised and run."""

    def _optimize_functions(self, ll_module: Any) -> None:
        """Optimise lightly. Fully, loops about calls would be taken for small ones and doubled before what
        is called is put in their place: the kernel would become twice as long, and slower."""
        ll_module.data_layout = self._codegen._data_layout
        for function in ll_module.functions:
            if not function.is_declaration:
                passes, builder = self._codegen._function_pass_manager(opt=1)
                passes.run(function, builder)

    def finalize(self) -> None:
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True


def _known_as(described: Any, environment: Any, library: _PartLibrary) -> Any:
    """What numba identifies a function by: what Python would call, here without code."""
    no_code = 0
    return numba._dynfunc.make_function(
        described.lookup_module(), described.qualname, "", no_code, environment, (library,)
    )


class _Pass(core.compiler_machinery.LoweringPass):
    def __init__(self) -> None:
        """numba's is abstract."""
        super().__init__()


@core.compiler_machinery.register_pass(mutates_CFG=False, analysis_only=False)
class _BeginPart(_Pass):
    _name = "begin_part"

    def run_pass(self, state: Any) -> bool:
        state.library = _PartLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        return True


@core.compiler_machinery.register_pass(mutates_CFG=False, analysis_only=False)
class _OfferPart(_Pass):
    """Let other functions call it."""

    _name = "offer_part"

    def run_pass(self, state: Any) -> bool:
        described = state.cr.fndesc
        known_as = _known_as(described, state.cr.env, state.library)
        state.cr = state.cr._replace(cfunc=known_as)
        state.targetctx.insert_user_function(known_as, described, [state.library])
        state.reload_init.extend(state.library._reload_init)
        return True


class KernelCompiler(core.compiler.Compiler):
    """numba's own compiler, with numbers of our own."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function of Python."""
        with _own_numbers():
            return super().compile_extra(func)


class PartCompiler(KernelCompiler):
    """The same with two more passes."""

    def define_pipelines(self) -> list:
        """The passes of numba with a first and a last one around its translation to LLVM."""
        passes = core.compiler.DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(_BeginPart, core.typed_passes.AnnotateTypes)
        passes.add_pass_after(_OfferPart, core.typed_passes.NativeLowering)
        passes.finalize()
        return [passes]


class _PartContents(KernelContents):
    """What is in the file of a part: its translation, with those of the parts that it calls."""

    suffix = "part"

    def check_cachable(self, data: Any) -> bool:
        """Whether other processes may use a result of the compiler: not where it calls a function of numba
        that this process had compiled before for others, under a number that those may have given too."""
        names = (one.name for one in data.library._final_module.functions if not one.is_declaration)
        numbers = (int(number) for name in names for number in re.findall(r"B\d+v(\d+)", name))
        return super().check_cachable(data) and all(number >= _FIRST for number in numbers)

    def reduce(self, result: Any) -> tuple:
        """The contents of the file, of a result of the compiler."""
        library, described = result.library, result.fndesc
        described.typemap = described.calltypes = None  # as numba does: these need not be kept
        environments = result.environment, tuple(result._find_referenced_environments())
        code = library._final_module.as_bitcode()
        return library.name, code, described, environments, result.signature, result.reload_init

    def rebuild(self, target_context: Any, payload: tuple) -> Any:
        """A result of the compiler, of the contents of the file."""
        name, code, described, (environment, referenced), signature, reload_init = payload
        for initialise in reload_init:
            initialise()
        library = _PartLibrary(target_context.codegen(), name)
        library._final_module = core.codegen.ll.parse_bitcode(code)
        library._reload_init.update(reload_init)
        library._finalized = True
        return core.compiler.CompileResult(
            typing_context=target_context.typing_context,
            target_context=target_context,
            entry_point=_known_as(described, environment, library),
            typing_error=None,
            type_annotation="",
            signature=signature,
            objectmode=False,
            lifted=(),
            fndesc=described,
            library=library,
            call_helper=None,
            environment=environment,
            metadata=None,
            reload_init=reload_init,
            referenced_envs=referenced,
        )


class PartCache(KernelCache):
    """numba's cache of a part."""

    contents: ClassVar = _PartContents
