"""What stands in a particle's way: faces of the container, wells, interior walls."""
