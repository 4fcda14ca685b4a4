"""Marks that are not a target's: coded dots, and the corners of ArUco markers and AprilTags, by name.

``marks.py`` finds those of a named dictionary; ``coded_dots.py`` and ``tags.py`` do so for either kind.
"""
