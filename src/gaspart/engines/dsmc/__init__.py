"""DSMC engine: collision partners are drawn at random among the particles of a cell (Bird 1994)."""
