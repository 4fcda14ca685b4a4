"""Nonlinear least squares: numerics only, no cameras in it."""
