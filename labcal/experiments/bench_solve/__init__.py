"""Benchmark of the solvers."""
