"""What stands in the laboratory, where the target goes in each view, and the truth of a view."""
