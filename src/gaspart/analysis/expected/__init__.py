"""Theory for a run, by the equation that its engine solves, for its number of particles."""
