"""Causes that might explain rows 17 to 23, whose printed errors are 100 times those of good pictures."""
