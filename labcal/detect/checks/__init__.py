"""Stage 4, parts: dots compared with the others of their picture, and dots that are not measured."""
