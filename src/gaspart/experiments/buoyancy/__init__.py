"""Under gravity."""

from gaspart.kinds import count, positive

TITLE = "Under gravity"
CHAPTER = "Gravity, heat and walls"
FIGURES = {
    "buoyancy": {
        "bins": count("bins of height"),
        "blocks": count("stretches of each replica"),
        "clear": positive("small diameters next to floor and ceiling that are left out, where layers are"),
        "far": positive(
            "horizontal distance from the large disc's centre beyond which the fluid is undisturbed"
        ),
        "near": positive("radius about that centre within which the missing small discs are counted"),
    }
}
