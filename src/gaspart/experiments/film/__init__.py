"""Thin films: thin_film."""
