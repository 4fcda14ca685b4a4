"""Support of a calibration by its views: what more views, tilts or places would bring."""
