"""Benchmark of detection, measurement and calibration with dots: ``labcal bench detect``."""
