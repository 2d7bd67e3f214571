"""Speed against accuracy: reversibility."""
