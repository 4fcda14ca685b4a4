"""The design of a target from paper, cameras and working distance."""
