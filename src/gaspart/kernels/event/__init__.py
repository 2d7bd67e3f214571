"""The event-driven engine: loop, queue, searches, growth."""
