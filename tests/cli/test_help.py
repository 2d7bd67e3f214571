"""The help of the commands, and completion in a shell."""

import shutil
import subprocess
import sys

import pytest

from gaspart.cli import commands, main


@pytest.mark.parametrize("name", commands())
def test_every_command_has_an_example(name):
    text = commands()[name].format_help()
    assert f"  gaspart {name} " in text or f"(gaspart {name} " in text


@pytest.mark.parametrize("name", commands())
def test_the_help_fits_into_a_terminal_of_80_columns(name, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    assert not [line for line in commands()[name].format_help().splitlines() if len(line) > 78]


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
