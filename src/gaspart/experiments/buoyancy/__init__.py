"""Under gravity: buoyancy."""
