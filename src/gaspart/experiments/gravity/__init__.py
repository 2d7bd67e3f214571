"""Under gravity: barometric, separation, heat_capacity."""
