"""Stage 3, parts: the model of a dot's edge, its least squares, and the statistics of its residuals."""
