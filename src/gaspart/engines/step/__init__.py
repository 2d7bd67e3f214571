"""Time-stepped engine, which searches for overlaps after each step (Frederickx & Meerts 2010)."""
