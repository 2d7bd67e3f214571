"""Theory for a run, for the equation of its engine and its number of particles."""
