"""Benchmark of ``labcal diagnose``: shoots with a mistake, and good ones."""
