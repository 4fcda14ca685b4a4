"""Calibration from several boards that are fixed to one plate, whose relative poses are unknown."""
