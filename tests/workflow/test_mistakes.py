"""A user's mistake, as Snakemake reports it: one line, exit code 2, nothing written."""

import pytest
from machine import WITHOUT_RIGHTS, why_not
from workspace import SMOKE, copy_of_project

pytestmark = pytest.mark.workflow


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("experiments: {virial_discs: {point: {mass: .nan}}}", "experiments.virial_discs.point.mass = nan"),
        ("experiments: {virial_discs: {grid: {packing_fraction: []}}}", "must not be empty"),
    ],
)
def test_a_bad_config_is_one_line_that_names_the_file(few, tmp_path, text, message):
    bad = tmp_path / "bad.yaml"
    bad.write_text(text)
    result = few.snakemake("--cores", "1", *SMOKE, str(bad))
    lines = [
        line for line in result.stdout.splitlines() if not line.startswith(("Using work", "Config file"))
    ]
    assert result.returncode == 2
    assert len(lines) == 1
    assert lines[0].startswith(f"gaspart: {bad}: ")
    assert message in lines[0]
    assert not (few.path / "results").exists()


def test_a_mistake_that_only_a_job_can_find_is_one_line_in_its_log(few, tmp_path):
    """Random insertion beyond saturation: the workflow fails, the log says why, and no output is left."""
    bad = tmp_path / "full.yaml"
    dense = "{point: {arrangement: random, count: 64}, grid: {packing_fraction: [0.6]}}"
    bad.write_text(f"experiments: {{virial_discs: {dense}}}")
    target = "results/smoke/points/virial_discs/packing_fraction=0.6"
    result = few.snakemake("--cores", "1", *SMOKE, str(bad), "--", target)
    assert result.returncode != 0
    log = (few.path / "results/smoke/logs/simulate/virial_discs/packing_fraction=0.6.log").read_text()
    assert log.splitlines()[-1].startswith("gaspart: simulate")
    assert "does not fit by random insertion" in log
    assert "Traceback" not in log
    assert not (few.path / target).exists()


@pytest.mark.skipif(why_not(WITHOUT_RIGHTS) is not None, reason=str(why_not(WITHOUT_RIGHTS)))
@pytest.mark.parametrize("folder", [".", "results"])
def test_a_folder_that_may_not_be_written_to_is_one_line(tmp_path, folder):
    workspace = copy_of_project(tmp_path)
    folder = tmp_path / folder
    folder.mkdir(exist_ok=True)
    folder.chmod(0o555)
    try:
        result = workspace.snakemake("--cores", "1", *SMOKE, within=WITHOUT_RIGHTS)
    finally:
        folder.chmod(0o755)
    assert result.returncode == 2
    assert result.stdout.splitlines()[-1] == (
        f"gaspart: folder = {str(folder)!r}: this user may not write to it, where the workflow keeps results"
    )
    assert "Traceback" not in result.stdout


def test_a_mistake_on_the_command_line_is_not_blamed_on_a_file(few):
    result = few.snakemake("--cores", "1", "--dry-run", *SMOKE, "--config", "sead=99")
    assert result.returncode == 2
    assert result.stdout.splitlines()[-1] == "gaspart: --config: sead = 99: unknown key; did you mean seed?"


def test_a_folder_without_a_config_is_one_line(few, tmp_path):
    elsewhere, small = tmp_path / "elsewhere", few.path / "config/smoke.yaml"
    elsewhere.mkdir()
    arguments = ("--cores", "1", "--dry-run", "--directory", str(elsewhere), "--configfile", str(small))
    result = few.snakemake(*arguments)
    assert result.returncode == 2
    assert result.stdout.splitlines()[-1] == (
        f"gaspart: folder = {str(elsewhere)!r}: has no config/config.yaml, over which others are laid: "
        "run this in the project's folder"
    )


def test_titles_with_braces_and_numbers_with_exponents_are_planned(few, tmp_path):
    """Snakemake fills braces in its parameters, and its reader takes 1e3 for text."""
    given = tmp_path / "given.yaml"
    title = 'title: "{x} $(touch PWNED) é <b>\\"\'"\n'
    given.write_text(f"{title}experiments: {{virial_discs: {{point: {{collisions_per_particle: 1e3}}}}}}\n")
    result = few.snakemake("--cores", "1", "--dry-run", *SMOKE, str(given))
    assert result.returncode == 0, result.stdout[-2000:]
