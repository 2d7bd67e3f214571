"""Claims in which a test states only what it is about."""

from gaspart.reproduction.claims import Claim, Estimate


def claim(value=1.0, error=0.01, required=0.02, expected=1.0, text="Z at 0.1", **others):
    """A claim about Z that agrees, unless the arguments change it."""
    others = {"source": "theory", "fails_if": "Z is wrong", "allowance_source": "its authors"} | others
    return Claim(claim=text, measured=Estimate(value, error), expected=expected, required=required, **others)
