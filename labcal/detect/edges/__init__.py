"""Stage 3, parts: pixels of a dot's edge, their model and least squares, statistics of the residuals."""
