"""Pixels to points in space with covariance, by a rig or a fitted model."""
