"""The help of the commands, and completion in a shell."""

import shutil
import subprocess

import pytest

from gaspart.cli import commands, main


@pytest.mark.parametrize("name", commands())
def test_every_command_has_an_example(name):
    text = commands()[name].format_help()
    assert f"  gaspart {name} " in text or f"(gaspart {name} " in text


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
