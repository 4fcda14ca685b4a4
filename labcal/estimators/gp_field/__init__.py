"""A smooth field of displacements in the picture: what a lens formula does not explain."""
