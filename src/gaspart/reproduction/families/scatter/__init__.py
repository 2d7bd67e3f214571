"""Figure on the scatter of all claims."""

from gaspart.keys import TEXT, list_of

TITLE = "All claims together"
CHAPTER = "Pictures and checks"
OF_CLAIMS = True
FIGURES = {
    "claims_scatter": {
        "experiments": list_of(TEXT, "none: it is made of the claims of all other figures", least=0, most=0)
    }
}
