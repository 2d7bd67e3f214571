"""Physics shared by all engines: contacts, collisions, flights, and random numbers."""
