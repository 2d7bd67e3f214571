"""Reproduction of published results: figures, their simulations and claims, and the report.

No other package imports this one.
"""
