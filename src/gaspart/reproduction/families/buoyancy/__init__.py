"""Figures on buoyancy under gravity."""

from gaspart.keys import count, names, positive

TITLE = "Under gravity"
CHAPTER = "Gravity, heat and walls"
FIGURES = {
    "buoyancy": {
        "source": names("the experiments of source C's own fluid"),
        "bins": count("bins of height"),
        "blocks": count("stretches of each replica"),
        "clear": positive("small diameters next to floor and ceiling that are left out, where layers are"),
        "far": positive(
            "small diameters across from the large disc's edge beyond which the fluid is undisturbed"
        ),
        "near": positive("small diameters around that edge within which missing small discs are counted"),
        "source_density": positive("at which source C expects its large disc to float in the middle"),
    }
}
