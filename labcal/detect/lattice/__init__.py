"""Stage 2, parts: the grid that the outlines form, and which of its nodes is which dot."""
