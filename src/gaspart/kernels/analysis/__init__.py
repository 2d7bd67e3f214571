"""Kernels of observables: sums over pairs of particles, and over waves."""
