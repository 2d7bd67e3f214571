"""Compilation of functions that only kernels call.

numba optimises every function and generates machine code for it. It optimises the function again inside each
caller, up to the kernel that Python calls. Here, functions called only by kernels are translated without
optimisation, and only the kernel is optimised and run. Optimising the other functions would take most of the
time of a first run. The translations are stored in files for other kernels that call the same functions. Most
of them do not depend on the features of a scene.
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
from gaspart.kernels.compile.narrowing import narrow_types

numba: Any = load_numba()
core: Any = numba.core

_FIRST = 2**32  # first function number of gaspart; numba counts from 1
_numbers = itertools.count(_FIRST + int.from_bytes(os.urandom(7), "big"))


@contextmanager
def _own_numbers() -> Iterator[None]:
    """Give functions that are compiled in this block numbers that no other process uses. This includes
    functions of numba. numba numbers the functions of a process, so that functions of the same name get
    different names in machine code. Translations from several processes are combined in one kernel, so no two
    processes may count from the same number.
    """
    identity = core.bytecode.FunctionIdentity
    before, identity._unique_ids = identity._unique_ids, _numbers
    try:
        yield
    finally:
        identity._unique_ids = before


def narrow_calls(part: Any) -> None:
    """Make callers compile a function only for the entries of its arguments that it uses."""

    def get_call_template(arguments: tuple, keywords: dict) -> tuple:
        signature, arguments = part._compiler.fold_argument_types(arguments, keywords)
        used = narrow_types(part.py_func, tuple(arguments))
        template, *_ = type(part).get_call_template(part, used, {})
        return template, signature, used, {}

    part.get_call_template = get_call_template


class _PartLibrary(core.codegen.JITCodeLibrary):
    """Code that is linked into its callers, and is fully optimised and run only there."""

    def _optimize_functions(self, ll_module: Any) -> None:
        """Perform light optimisation. Full optimisation would treat loops around calls as small loops and
        duplicate them before the called functions are inlined. The kernel would become twice as long, and
        slower. With NUMBA_OPT=0 there is no optimisation.
        """
        ll_module.data_layout = self._codegen._data_layout
        for function in ll_module.functions:
            if numba.config.OPT and not function.is_declaration:
                passes, builder = self._codegen._function_pass_manager(opt=1)
                passes.run(function, builder)

    def finalize(self) -> None:
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True


def _known_as(described: Any, environment: Any, library: _PartLibrary) -> Any:
    """Return the object by which numba identifies a function, without callable code."""
    no_code = 0
    return numba._dynfunc.make_function(
        described.lookup_module(), described.qualname, "", no_code, environment, (library,)
    )


class _Pass(core.compiler_machinery.LoweringPass):
    def __init__(self) -> None:
        """Satisfy the abstract constructor of numba."""
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
    """Compiler pass that makes a function callable by other functions."""

    _name = "offer_part"

    def run_pass(self, state: Any) -> bool:
        described = state.cr.fndesc
        known_as = _known_as(described, state.cr.env, state.library)
        state.cr = state.cr._replace(cfunc=known_as)
        state.targetctx.insert_user_function(known_as, described, [state.library])
        state.reload_init.extend(state.library._reload_init)
        return True


class KernelCompiler(core.compiler.Compiler):
    """Compiler of numba with the function numbers of gaspart."""

    def compile_extra(self, func: Any) -> Any:
        """Compile a function of Python."""
        with _own_numbers():
            return super().compile_extra(func)


class PartCompiler(KernelCompiler):
    """Compiler of functions that only kernels call, with two additional passes."""

    def define_pipelines(self) -> list:
        """Return numba's passes with one pass added before and one after translation to LLVM."""
        passes = core.compiler.DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(_BeginPart, core.typed_passes.AnnotateTypes)
        passes.add_pass_after(_OfferPart, core.typed_passes.NativeLowering)
        passes.finalize()
        return [passes]


class _PartContents(KernelContents):
    """Content of the file of a part: its translation and the translations of called parts."""

    suffix = "part"

    def check_cachable(self, data: Any) -> bool:
        """Return True if other processes may use a compiler result. The result is False if the code calls a
        function of numba that this process had already compiled for other callers, because other processes
        may have given its number to another function.
        """
        functions = data.library._final_module.functions
        names = (function.name for function in functions if not function.is_declaration)
        numbers = (int(number) for name in names for number in re.findall(r"B\d+v(\d+)", name))
        return super().check_cachable(data) and all(number >= _FIRST for number in numbers)

    def reduce(self, result: Any) -> tuple:
        """Return the content of the file for a compiler result."""
        library, described = result.library, result.fndesc
        described.typemap = described.calltypes = None  # as in numba: these need not be stored
        environments = result.environment, tuple(result._find_referenced_environments())
        code = library._final_module.as_bitcode()
        return library.name, code, described, environments, result.signature, result.reload_init

    def rebuild(self, target_context: Any, payload: tuple) -> Any:
        """Rebuild a compiler result from the content of a file."""
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
    """Cache of a function that only kernels call; it replaces numba's own cache."""

    contents: ClassVar = _PartContents
