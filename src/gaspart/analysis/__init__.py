"""Observables with uncertainties: correlations, order, coexistence, statistics."""
