"""Jobs of a grid point other than a trajectory: cost, comparison, echo, insertion, growth, machine code."""
