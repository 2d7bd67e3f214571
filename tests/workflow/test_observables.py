"""Observables are declared once: no other table of their names remains, and each declaration is complete."""

import ast
import inspect
from importlib import import_module

import pytest

from gaspart import analysis, theory
from gaspart.analysis.declaration import DIMENSIONS, powers_of, units_in
from gaspart.analysis.observables import OBSERVABLES, about, observables_with
from gaspart.reproduction.points.modules import PACKAGE
from gaspart.theory import bulk
from gaspart.theory.equations import carnahan_starling

HOME = "analysis/observables.py"
WORDS = {
    "accuracy/of_step.py": "what a bound on the error of a step exists for",
    "analysis/fields.py": "quantities of a field",
    "rendering/view.py": "by what particles are coloured",
    "theory/geometry.py": "names of arguments",
    "errors.py": "words of other programs",
    "theory/columns.py": "what differs between two columns of gas",
}
"""Modules in which some of the names are words of something else, beside the figures, whose data sets have
columns of these names."""
NEEDS = ("", "paths", "pairs", "fluxes", "shear")
FIGURES = "reproduction/figures/"
OWN = "reproduction/figures/own.py"


def literals(node):
    """The texts that a literal collection, or the arguments of a call, hold."""
    if isinstance(node, ast.Tuple | ast.List | ast.Set):
        parts = node.elts
    elif isinstance(node, ast.Dict):
        parts = [key for key in node.keys if key is not None]
    elif isinstance(node, ast.Call):
        parts = node.args
    else:
        return set()
    return {part.value for part in parts if isinstance(part, ast.Constant) and isinstance(part.value, str)}


def tables(source):
    """The lines of a module with a collection of two names of observables or more."""
    nodes = ast.walk(ast.parse(source))
    return [node.lineno for node in nodes if len(literals(node) & set(OBSERVABLES)) > 1]


def test_no_other_table_of_names_exists():
    found = {}
    for path in PACKAGE.rglob("*.py"):
        name = str(path.relative_to(PACKAGE))
        if name != HOME and (name == OWN or not name.startswith(FIGURES)):
            if lines := tables(path.read_text(encoding="utf-8")):
                found[name] = lines
    assert set(found) <= set(WORDS), found


def test_the_search_sees_tables():
    assert tables('X = ("Z", "D")') == [1] and tables('f({"msd": 1, "vacf": 2})') == [1]
    assert tables('choice("observable", "Z", "D")') == [1] and tables('X = "Z", "other"') == []
    assert tables((PACKAGE / HOME).read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", OBSERVABLES)
def test_a_declaration_is_complete(name):
    one = OBSERVABLES[name]
    function = inspect.signature(getattr(analysis, one.function)).parameters
    assert {*one.arguments, *one.selections, "start"} <= set(function)
    assert set(one.along) <= set(DIMENSIONS) and one.needs in NEEDS
    assert one.scatter in ("run", "particles") and one.merged in ("", "split", "lost")
    assert one.samples in ("", "structure", "paths") and one.relative_to in ("value", "norm")
    assert set(one.nothing) <= {"boltzmann", "enskog"}
    if one.theory:
        module, expect = one.theory.split(".")
        assert callable(getattr(import_module(f"gaspart.analysis.expected.{module}"), expect))
    assert bool(one.bulk) == bool(one.source)
    if one.bulk:
        assert callable(getattr(bulk, one.bulk))
    if one.mixture:
        assert callable(getattr(theory, one.mixture))
    if one.tabulated:
        assert callable(getattr(bulk, f"finite_{one.bulk}"))
    assert one.lags == 0 or one.samples == ""


def test_units_are_powers():
    assert units_in("mass length^(2-d) / time", 3) == "mass length^-1 / time"
    assert units_in("energy / length^d", 2) == "energy / length^2"
    assert powers_of("mass length^(2-d) / time", 3) == (-1, 1, -1)
    assert powers_of("energy / length^d", 3) == (-1, 1, -2)
    assert powers_of("1 / (length^(d-2) time)", 3) == (-1, 0, -1)
    assert about("D", 3) == {"units": "length^2 / time", "long_name": "diffusion coefficient D"}


def test_the_power_of_the_temperature_is_that_of_the_units():
    """Times are proportional to T^(-1/2): only of curves the value at a lag, or a speed, is another one."""
    for name, one in OBSERVABLES.items():
        if one.form != "curve":
            assert one.power == -0.5 * one.powers(3)[2], name


def test_mutual_diffusion_is_transport():
    """It was missing in one of thirteen tables."""
    assert "mutual_diffusion" in observables_with(memory=True)
    assert set(observables_with(needs="paths")) <= set(observables_with(memory=True))


def test_the_equation_of_dsmc_is_its_contact_value():
    gas = bulk.Gas(3, 0.3, 10, 1.0, 1.0)
    assert bulk.compressibility_factor(gas, "enskog") == pytest.approx(carnahan_starling(0.3))
