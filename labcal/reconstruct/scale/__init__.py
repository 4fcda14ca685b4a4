"""Known distances between named points, which enter a measurement as observations."""
