"""A shoot: the folder of pictures on which the two arms meet, and its truth, kept apart."""
