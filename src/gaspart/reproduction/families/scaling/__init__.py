"""Figures on the gain from space partitioning."""

from gaspart.keys import COUNT, count, list_of, positive, record

TITLE = "Gain from space partitioning"
CHAPTER = "Speed and accuracy"
FIGURES = {
    "naive_scaling": {},
    "box_count": {
        "round_per_side": list_of(COUNT, "boxes per side that source A found quicker for their round width"),
        "source_boxes_per_particle": positive(
            "the ideal number of boxes per particle in source A's figure 6"
        ),
    },
    "ideal_boxes": {
        "rule": positive("source A's boxes per particle"),
        "source_numbers": list_of(
            record(
                {
                    "count": count("number of particles"),
                    "radius": positive("radius"),
                    "boxes_per_particle": positive("ideal number of boxes per particle"),
                }
            ),
            "what source A found for the largest gas of its figures 5, 6 and 7",
        ),
        "source_plateaus": list_of(
            record(
                {
                    "radius": positive("radius"),
                    "counts": list_of(COUNT, "least and largest number of particles", 2, 2),
                    "boxes_per_side": count("the ideal number of boxes per side in this range"),
                }
            ),
            "where source A's ideal number of boxes does not depend on the number of particles",
        ),
    },
    "linear_scaling": {
        "source_figures": list_of(
            record(
                {
                    "radius": positive("radius"),
                    "counts": list_of(COUNT, "least and largest number of particles", 2, 2),
                }
            ),
            "source A's figures 8, 9 and 10",
        ),
        "naive_count": count("number of particles to which the naive method is extrapolated"),
        "source_years": positive("years that source A states for it"),
    },
    "event_scaling": {
        "fit_from": record(
            {search: count(f"search `{search}`") for search in ("pairs", "direct", "boxes")},
            "for each search the least number of particles in the fits",
        )
    },
}
