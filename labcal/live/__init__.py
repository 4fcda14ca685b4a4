"""The live page of a capture: a server for one browser at the bench, and what it shows."""
