"""Benchmarks, measured when the command runs."""
