"""Tests of a calibration against new views: whether, where and by how much the rig has changed."""
