"""DSMC engine: collision partners are sampled among the particles of a cell (Bird 1994)."""
