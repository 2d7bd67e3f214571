"""Time-stepped engine: overlaps found after each step (Frederickx & Meerts 2010)."""
