"""Figures on direct simulation Monte Carlo (DSMC)."""

from gaspart.keys import count, names, record

TITLE = "Direct simulation Monte Carlo"
CHAPTER = "Speed and accuracy"
FIGURES = {
    "dsmc_convergence": {
        "blocks": count("stretches of each run between plates"),
        "parts": record(
            {
                "fluxes": names("dilute gases with correlations of the stress"),
                "paths": names("dilute gases with displacements"),
                "dense": names("the Enskog model"),
                "plates": names("gases between a hot and a cold plate"),
                "event_paths": names("gases of the event-driven engine, as `msd_spheres`"),
                "event_plates": names("gases of the event-driven engine between such plates"),
            },
            "the experiments of each part",
        ),
    }
}
