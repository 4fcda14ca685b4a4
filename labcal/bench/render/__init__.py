"""Benchmark of the rendered laboratory: its errors and its cost, ``labcal bench render``."""
