"""The residual field: smooth displacements in the picture that the lens formula does not explain."""
