"""Speed against accuracy."""

from gaspart.kinds import flag

TITLE = "Speed against accuracy"
CHAPTER = "Speed and accuracy"
FIGURES = {
    "price_of_features": {
        "count_instructions": flag(
            "count instructions of compiled kernels against ones whose source never had the features"
        )
    }
}
