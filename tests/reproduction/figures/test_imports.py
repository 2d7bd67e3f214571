"""What every reading of a config imports."""

import subprocess
import sys


def test_names_and_settings_of_figures_need_neither_scipy_nor_matplotlib():
    """Snakemake reads the config anew for many jobs: functions of the figures import what takes long."""
    code = "from gaspart.reproduction import registry; import sys; registry.settings()"
    code += "; print(*{'scipy', 'matplotlib', 'numba'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
