"""Detections in the files of other systems, one file a format."""
