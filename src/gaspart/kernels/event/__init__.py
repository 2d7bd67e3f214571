"""Event-driven engine: loop, queue, searches, growth."""
