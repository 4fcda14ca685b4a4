"""Verdicts: what to expect in millimetres, whether to believe it, what limits it, what to do next."""
