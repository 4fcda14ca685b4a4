"""Poses, rays and triangulation: geometry that knows no lens."""
