"""Benchmarks of boards with squares: drawn pictures, and the bound of their corners."""
