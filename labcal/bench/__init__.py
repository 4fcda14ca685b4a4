"""Benchmarks: what an issue asks for in figures, measured when the command runs."""
