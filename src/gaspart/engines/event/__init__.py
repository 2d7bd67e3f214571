"""Event-driven engine, which advances from event to event (Spencer 2021 and 2022)."""
