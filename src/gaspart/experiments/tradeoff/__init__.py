"""Speed against accuracy: speed_accuracy, time_to_accuracy."""
