"""Event-driven engine: from one event to the next (Spencer 2021 and 2022)."""
