"""The reproduction: figures, their points and claims, and the report. No other package needs it."""
