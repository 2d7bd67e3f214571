"""Families of figures: a folder for each family, with `measure.py`, `claims.py` and `figure.py`."""
