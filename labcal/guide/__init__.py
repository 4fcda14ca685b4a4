"""Guidance before and between measurements: what to expect of a rig, whether a calibration is still valid."""
