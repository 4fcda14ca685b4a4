"""Cameras: lens models, the paper's camera, rigs, and the image of a dot."""
