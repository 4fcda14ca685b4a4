"""Stage 1, parts: dark spots of a picture, and the ellipses of their edges."""
