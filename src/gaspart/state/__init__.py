"""All particles at one time: State and Tally, random streams, initial states."""
