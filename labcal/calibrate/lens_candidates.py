"""The candidate lenses, the simplest first, of which the first that is as good as the best is chosen."""

AUTO = "auto"
"""In the place of a lens model's name: the one that held-out views, or held-out points, choose."""
DEFAULT_LENS = "brown5"
"""Of ``calibrate``, where neither a lens model nor a rig to start from is given."""

OF_VIEWS = ("pinhole", "brown-k1k2", "brown5", "rational8", "thin-prism12", "fisheye-kb4")
"""For a target in the hand. The fisheye is last: for a lens that is none it is about as good as others with
as many coefficients, and for one that is, the others are no match."""
LARGE, PLENTY = "thin-prism12", 20
"""A candidate only from so many views of every camera on."""

OF_POINTS = ("pinhole", "brown-k1k2", "brown5", "fisheye-kb4", "rational8")
"""For a target at known places: by how many coefficients they have."""
