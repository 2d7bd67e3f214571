"""Where the time of a reproduction went, and which length suffices."""

import math
import subprocess
import sys

import pytest
from reproduction.claims.data import claim

from gaspart.reproduction import job_time
from gaspart.reproduction.claims.judging import sufficient


def test_the_length_that_suffices_goes_as_the_square_of_the_uncertainty():
    assert sufficient(claim(1.0, 0.01)) == pytest.approx(4.0 * sufficient(claim(1.0, 0.005)))
    required = claim(1.0, 0.01).required
    assert sufficient(claim(1.0, required)) == pytest.approx(1.0)
    distinguished = claim(1.0, 0.01, alternative=1.02)
    assert sufficient(distinguished) == pytest.approx((0.01 / (0.02 / 2.0)) ** 2, rel=0.2)
    assert math.isnan(sufficient(claim(1.0, 0.0)))
    assert math.isinf(sufficient(claim(1.0, 0.01, alternative=1.0)))


SPIN = """
import subprocess, sys, time
from gaspart.reproduction import job_time
spin = "import time\\nwhile time.process_time() < 0.3: pass"
exec(spin)
subprocess.run([sys.executable, "-c", spin], check=True)
print("0.5 of the work is done")
print(job_time.describe())
"""


def test_a_job_states_its_memory_and_its_processor_time_with_that_of_its_children(tmp_path):
    log = tmp_path / "logs/simulate/virial/eta=0.25.log"
    log.parent.mkdir(parents=True)
    with log.open("w") as file:
        subprocess.run([sys.executable, "-c", SPIN], stdout=file, check=True)
    used = job_time.read_used(tmp_path, "simulate", "virial", "eta=0.25")
    assert (
        used.seconds >= 0.58 and 5.0 < used.memory < 4000.0
    )  # of a copy of this process at first, before it runs another program
    log.write_text("processor time: 1.0 s of something\n")
    assert job_time.read_used(tmp_path, "simulate", "virial", "eta=0.25") is None
    assert job_time.read_used(tmp_path, "simulate", "virial", "eta=0.2") is None
