"""The laboratory: its objects, the placement of the target in each view, and the truth of a view."""
