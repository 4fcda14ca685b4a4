"""The study of neurons and layers, which the paper mentions and does not show."""
