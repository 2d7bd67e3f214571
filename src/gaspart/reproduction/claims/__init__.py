"""Claims: a measured number, the statement of theory, literature or source, and the verdict.

A test or identity agrees, disagrees, or is inconclusive: its uncertainty is above the one required, it does
not exclude the competing theory, or it lies outside a stated bound without being significantly so.
Inconclusive is not a pass. A reproduction of a source's report is reproduced, or the source is in error, with
the reason why. A number whose reference has not been verified has no verdict.

With hundreds of claims some exceed 3 sigma by chance, so the claims of one figure are a family, and a family
as a whole is wrong about a true statement with the probability of one 3-sigma test (Holm's correction at the
level 0.0027, two-sided). In addition, a two-sided chi-square tests the deviations of all its values together:
uncertainties that are too large are as wrong as those that are too small. Where an uncertainty comes from a
few samples, a deviation follows Student's t. `families/<family>/claims.py` states what figures claim.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__)
