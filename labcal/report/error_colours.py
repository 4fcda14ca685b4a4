"""Colours of errors from small to large, for light and dark grounds, and for the colour-blind."""

from matplotlib.colors import LinearSegmentedColormap

STOPS = ("#3b82c4", "#c9a227", "#d2493a")
"""Blue, yellow, red."""
ERROR_COLOURS = LinearSegmentedColormap.from_list("labcal-errors", STOPS)
