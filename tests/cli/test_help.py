"""The help of the commands, and completion in a shell."""

import re
import shutil
import subprocess
import sys

import pytest

from gaspart.analysis.observables import OBSERVABLES
from gaspart.cli import _COMMANDS, commands, main
from gaspart.cli.options import engine_settings


@pytest.mark.parametrize("name", commands())
def test_every_command_has_an_example(name):
    text = commands()[name].format_help()
    assert f"  gaspart {name} " in text or f"(gaspart {name} " in text


@pytest.mark.parametrize("name", commands())
def test_the_help_fits_into_a_terminal_of_80_columns(name, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    assert not [line for line in commands()[name].format_help().splitlines() if len(line) > 78]


def test_the_help_has_an_observable_a_line_and_settings_of_engines_apart(monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    parsers = commands()
    text = parsers["measure"].format_help()
    for name in (*OBSERVABLES, "field"):
        assert re.search(rf"^  {name}(\n {{23}}| ) *\S", text, re.MULTILINE), name
    usual, _, expert = parsers["run"].format_help().partition("\nsettings of the engines:\n")
    for name in engine_settings():
        option = re.compile(rf"^  --(no-)?{name.replace('_', '-')}\b", re.MULTILINE)
        assert option.search(expert) and not option.search(usual), name


@pytest.mark.parametrize(
    ("words", "expected"),
    [(["mea"], ["measure"]), (["measure", "a.nc", "ms"], ["msd"]), (["run", "--du"], ["--duration"])],
)
def test_bash_completes_words(words, expected, tmp_path, capsys):
    bash = shutil.which("bash")
    if bash is None:
        pytest.skip("bash is not installed")
    assert main(["completion", "bash"]) == 0
    script = tmp_path / "completion.bash"
    script.write_text(capsys.readouterr().out)
    line = f"source {script}; COMP_WORDS=(gaspart {' '.join(words)}); COMP_CWORD={len(words)}; "
    line += (
        'function=$(complete -p gaspart | sed "s/.*-F \\([^ ]*\\).*/\\1/"); $function; echo "${COMPREPLY[@]}"'
    )
    done = subprocess.run([bash, "-c", line], capture_output=True, text=True)
    assert done.stdout.split() == expected, done.stderr


def imported(code):
    """The modules that a new interpreter imports for some code."""
    text = f"import sys\n{code}\nprint(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    return set(done.stderr.split())


def test_the_help_starts_with_few_imports():
    """0.07 s with 100 modules. Loading every command took 0.3 s."""
    help = "from gaspart.cli import main\ntry: main(['--help'])\nexcept SystemExit: pass"
    modules = imported(help) - imported("")
    commands_loaded = {name for name in modules if name.startswith("gaspart.cli.")}
    assert commands_loaded == {"gaspart.cli.arguments", "gaspart.cli.progress"}
    assert "numpy" not in modules and len(modules) < 100, sorted(modules)


def test_the_list_of_commands_has_a_description_for_each(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    text = " ".join(capsys.readouterr().out.split())
    for name, (_, brief) in _COMMANDS.items():
        assert f" {name} {brief} " in text
    assert "examples: gaspart new gas.yaml" in text
