"""Targets: grids of dots with three ring markers, and their artwork."""
