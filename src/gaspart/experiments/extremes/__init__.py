"""Speed, accuracy, stability: stability_extremes."""
