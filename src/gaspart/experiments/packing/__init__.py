"""Random insertion: densest_fill."""
