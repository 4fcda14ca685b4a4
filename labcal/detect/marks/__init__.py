"""Marks that are no grid: coded dots, and the corners of ArUco markers and AprilTags, as named pixels.

``coded_dots.py`` and ``tags.py`` find them; ``coded_sheet.py`` makes a target of a sheet of coded dots.
"""
