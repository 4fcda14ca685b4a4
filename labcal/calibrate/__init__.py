"""Cameras from pictures of a target: held in the hand, or at known places."""
