"""Random insertion: fill_failures."""
