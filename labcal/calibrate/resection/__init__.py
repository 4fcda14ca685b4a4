"""Resection: a camera from points in space that it saw, whatever its lens."""
