"""Claims: measured numbers compared with theory, literature or a source, and their verdicts.

A test or identity agrees, disagrees, or is inconclusive. It is inconclusive in three cases: its uncertainty
is larger than required; it does not exclude the competing theory; or the number violates a bound, but not
significantly. Inconclusive is not a pass. A reproduction repeats a published result. Its verdict is
"reproduced" or "source in error". The verdict "source in error" states the reason. A number whose reference
has not been verified has no verdict.

Among hundreds of claims, some deviate by more than 3 sigma by chance. Therefore the claims of one figure are
tested as a family. A family rejects at least one true claim with the same probability as a single 3-sigma
test (Holm's correction at the level 0.0027, two-sided). In addition, a two-sided chi-square tests the
deviations of all values of the family together, because uncertainties that are too large are also wrong. If
an uncertainty is computed from a few samples, the deviation is tested with Student's t. The claims of figures
are in the modules of `figures`.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__)
