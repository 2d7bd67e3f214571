"""Comparison of our values with values by others."""

from gaspart.keys import names

TITLE = "Beside values of others"
CHAPTER = "Equation of state and structure"
FIGURES = {
    "literature": {"judged": names("experiments whose values have claims of their own, not only together")}
}
