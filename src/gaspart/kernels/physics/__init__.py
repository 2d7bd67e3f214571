"""Physics that all engines share: contacts, collisions, flight, random numbers."""
