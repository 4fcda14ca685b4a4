"""Measurement of marks, coded dots and tags, on drawn pictures whose truth is exact."""
