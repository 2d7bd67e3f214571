"""pymbar and emcee: the standard error of the mean of correlated series."""

import json

import emcee
import netCDF4
import numpy as np
from finding import SIGMA, Finding
from pymbar import timeseries


def compared(folder, inefficiency):
    """Mean over all series of gaspart's standard error over a referee's; its own error by the scatter."""
    stated = json.loads((folder / "stated.json").read_text())
    ratios = []
    for path, ours in zip(sorted(folder.glob("series_*.nc")), stated["standard_errors"], strict=True):
        with netCDF4.Dataset(path) as file:
            values = np.array(file["kinetic_energy"][stated["dropped"] :])
        ratios.append(ours / np.sqrt(values.var() * inefficiency(values) / values.size))
    error = np.std(ratios, ddof=1) / np.sqrt(len(ratios))
    ratio = np.mean(ratios)
    return Finding(f"{ratio:.4f} of it", f"1 ± {error:.4f}", float(abs(ratio - 1.0) / error), 3.0, SIGMA)


def pymbar(folder):
    return compared(folder, timeseries.statistical_inefficiency)


def of_emcee(folder):
    return compared(folder, lambda values: emcee.autocorr.integrated_time(values, c=5)[0])
