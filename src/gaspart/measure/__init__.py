"""From simulations to numbers with uncertainties: one module a family, one function a figure.

``gaspart.measure.<family>.<figure>(points, settings)`` gives an ``xarray.Dataset``; which figure is of which
family stands in ``gaspart.families``. ``cost`` and ``fill`` are the measurements that are jobs of their own.
"""
