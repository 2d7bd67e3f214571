"""How functions are compiled that only kernels call.

numba optimises every function and makes machine code of it, and optimises it again within each function that
calls it, up to the kernel that Python calls. These are only translated, and left to the last: what runs is
that one, and the others would be most of the time that a first run takes.
"""

from __future__ import annotations

from typing import Any

from gaspart.kernels.numba_loading import load_numba

numba: Any = load_numba()
core: Any = numba.core


class _PartLibrary(core.codegen.JITCodeLibrary):
    """Code that is linked into that of the callers, and neither optimised nor run by itself."""

    def finalize(self) -> None:
        for library in dict.fromkeys(self._linking_libraries):
            self._reload_init.update(library._reload_init)
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True


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
        described, environment = state.cr.fndesc, state.cr.env
        no_code = 0  # numba identifies a function by what Python would call
        known_as = numba._dynfunc.make_function(
            described.lookup_module(), described.qualname, "", no_code, environment, (state.library,)
        )
        state.cr = state.cr._replace(cfunc=known_as)
        state.targetctx.insert_user_function(known_as, described, [state.library])
        state.reload_init.extend(state.library._reload_init)
        return True


class PartCompiler(core.compiler.CompilerBase):
    """numba's own compiler but for these two passes."""

    def define_pipelines(self) -> list:
        """The passes of numba with a first and a last one around its translation to LLVM."""
        passes = core.compiler.DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(_BeginPart, core.typed_passes.AnnotateTypes)
        passes.add_pass_after(_OfferPart, core.typed_passes.NativeLowering)
        passes.finalize()
        return [passes]
