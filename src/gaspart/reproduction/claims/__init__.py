"""Claims: a measured number, the statement of theory, literature or source, and the verdict.

A test or identity agrees, disagrees, or is inconclusive. It is inconclusive in three cases: its uncertainty
is larger than required, it does not exclude the competing theory, or it is outside of a bound, but not
significantly. Inconclusive is not a pass. A reproduction of a source's report is reproduced, or the source is
in error, with the reason why. A number whose reference has not been verified has no verdict.

With hundreds of claims some exceed 3 sigma by chance. Therefore the claims of one figure are a family. The
probability that a family rejects any true claim equals the probability of one 3-sigma test (Holm's correction
at the level 0.0027, two-sided). In addition, a two-sided chi-square tests the deviations of all its values
together, because uncertainties that are too large are also wrong. If an uncertainty is computed from a few
samples, the deviation is tested with Student's t. `families/<family>/claims.py` contains the claims of
figures.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__)
