"""Advice before and between measurements: what a rig will measure, and what to change."""
