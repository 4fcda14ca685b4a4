"""Stage 4, parts: dots compared with the others of their picture, dots not measured, pictures refused."""
