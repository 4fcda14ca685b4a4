"""Diagnosis of a shoot: what is wrong with it, what that costs in mm, and how to mend it."""
