"""A large body in a gas: brownian_paths, brownian_msd."""
