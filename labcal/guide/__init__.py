"""Guidance: whether a calibration is still valid, and what to do if it is not."""
