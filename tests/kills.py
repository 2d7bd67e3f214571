"""Runs that are disturbed by signals at random moments and continued, in processes forked from this one.

`python kills.py FOLDER SEED SIGNALS` sends that many signals and prints what it found as JSON. Numba and most
kernels are loaded before the forks, because that would take most of the time; tests/test_interruption.py
disturbs a few processes from their start on.
"""

import collections
import json
import os
import signal
import sys
import time
from pathlib import Path

import numpy as np
from scenes import gas

from gaspart.kernels.compile.cache import load_numba

KINDS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
EXPECTED = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGKILL: -9}
STEP = ["--engine", "step", "--time-step", "0.015625"]
ENGINES = {"event": [], "step": [*STEP, "--threads", "1"], "threads": [*STEP, "--threads", "2"]}
LENGTH = {"event": "120", "step": "60", "threads": "6"}  # two threads are slow on a machine that is busy


def settings_of(engine):
    """The options of a run that takes about a second."""
    settings = [*ENGINES[engine], "--duration", LENGTH[engine], "--sample-interval", "2", "--seed", "3"]
    return [*settings, "--displacements", "--quiet"]


def start(arguments, errors):
    """Fork a process that carries out a command line, with stderr in a file; returns its number."""
    signal.pthread_sigmask(signal.SIG_BLOCK, KINDS[:2])
    child = os.fork()
    if child:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, KINDS[:2])
        return child
    code = 99
    try:
        for number in KINDS[:2]:  # what the command line does first
            signal.signal(number, lambda signum, frame: os._exit(128 + signum))
        signal.pthread_sigmask(signal.SIG_UNBLOCK, KINDS[:2])
        os.dup2(os.open(errors, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        from gaspart.__main__ import main

        sys.argv = ["gaspart", *map(str, arguments)]
        code = main()
    finally:
        os._exit(code)


def finished(child):
    """Wait for a process; returns its exit code, negative for a signal."""
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def disturb(rng, folder, engine, report):
    """Start a run, disturb it a few times at random moments, let it end, and compare it with `whole.nc`."""
    path, errors, scene = folder / f"{engine}.nc", folder / "errors", folder / "scene.yaml"
    run = ["run", scene, "-o", path, *settings_of(engine)]
    resume, command, sent = ["resume", path, "--quiet"], run, 0
    while True:
        child = start(command, errors)
        kind = KINDS[rng.integers(3)]
        time.sleep(rng.choice([0.2, 1.0, 3.0]) * rng.random())
        os.kill(child, kind)
        sent, begun = sent + 1, time.monotonic()
        if rng.random() < 0.2:
            time.sleep(rng.uniform(0.0, 0.05))
            os.kill(child, kind)
        code = finished(child)
        report["latest"] = max(report["latest"], time.monotonic() - begun) if code else report["latest"]
        printed = errors.read_text()
        report["codes"][f"{kind.name} {code}"] += 1
        assert code in (0, EXPECTED[kind]) or (code == 2 and command is resume), (kind, code, printed)
        assert printed.count("\n") <= 1 and "Traceback" not in printed, printed
        if "`gaspart resume" in printed:
            report["continued"] += 1
            assert path.with_name(f"{path.name}.checkpoint.npz").exists(), printed
        if code == 0 or sent == 6:
            break
        command = (run, resume)[rng.integers(2)] if code != 2 else run
    assert finished(start(run, errors)) == 0, errors.read_text()
    assert path.read_bytes() == (folder / f"whole-{engine}.nc").read_bytes()
    assert {file.name for file in folder.iterdir() if file.name.startswith(path.name)} == {path.name}
    path.unlink()
    return sent


def main(folder, seed, signals):
    os.environ["GIT_DIR"] = str(folder)  # no revision: somebody may edit the checkout meanwhile
    load_numba(ours=True)
    import gaspart as gp

    for engine in (gp.EventDriven(), gp.TimeStepped(0.015625)):
        simulation = gp.Simulation(gas(3, 2000, 0.2), engine, 3)
        simulation.advance(0.125)
        simulation.restore(simulation.checkpoint())
        simulation.check_invariants()
    gas(3, 2000, 0.2).to_file(folder / "scene.yaml")
    for engine in ENGINES:
        arguments = ["run", folder / "scene.yaml", "-o", folder / f"whole-{engine}.nc", *settings_of(engine)]
        assert finished(start(arguments, folder / "errors")) == 0, (folder / "errors").read_text()
    report = {"signals": 0, "runs": 0, "continued": 0, "latest": 0.0, "codes": collections.Counter()}
    rng = np.random.default_rng(seed)
    while report["signals"] < signals:
        report["signals"] += disturb(rng, folder, list(ENGINES)[report["runs"] % 3], report)
        report["runs"] += 1
        print(json.dumps(report), file=sys.stderr, flush=True)
    print(json.dumps(report))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
