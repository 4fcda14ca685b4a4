"""Errors in millimetres, against truth or against the target's own lengths."""
