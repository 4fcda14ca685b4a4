"""Families of camera pairs that depart from the pinhole by a strength, and the volumes that they see."""
