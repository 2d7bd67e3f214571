"""The figures: a folder per family, with `measure.py`, `claims.py` and `figure.py`."""
