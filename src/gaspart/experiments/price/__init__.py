"""Speed against accuracy: price_of_features."""
