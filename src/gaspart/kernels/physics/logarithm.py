"""Constants of the logarithm that has the same bits on every machine, for numpy and kernels."""

LN2 = 0.6931471805599453
LOG_SERIES = tuple(1.0 / (2 * k + 1) for k in range(12))
"""Coefficients of the series of artanh in odd powers, from which logarithms are computed."""
