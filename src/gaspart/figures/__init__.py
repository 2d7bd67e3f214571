"""From numbers and curves to pictures: one module a family, one function a figure; no number is made here.

``gaspart.figures.<family>.<figure>(dataset)`` gives a ``matplotlib.figure.Figure``.
"""
