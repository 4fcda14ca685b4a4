"""Detections of one's own in a benchmark of distortion: methods on real pixels of a target on a stage."""
