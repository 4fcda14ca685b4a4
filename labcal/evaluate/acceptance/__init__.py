"""Acceptance test of a measuring system by known lengths, in the manner of VDI/VDE 2634 Part 1."""
