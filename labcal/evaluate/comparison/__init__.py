"""Differences of two calibrations after the rigid motion that no measurement tells."""
