"""Benchmark of robustness to distortion: methods on cameras that depart from the pinhole step by step."""
