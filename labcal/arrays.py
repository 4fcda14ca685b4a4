"""Names for the array shapes that cross module borders; checked while testing (jaxtyping, beartype).

Arrays are float64; missing values are NaN. Leading dimensions run view, camera, dot.
"""

import numpy as np
from jaxtyping import Bool, Float64, Int

Pixels = Float64[np.ndarray, "*batch 2"]
"""Pixel positions q, (0, 0) at the centre of the top-left pixel."""

Outlines = Float64[np.ndarray, "*batch samples 2"]
"""Closed curves in a picture, one an element, as pixel positions along them."""

Vectors3 = Float64[np.ndarray, "*batch 3"]
"""Points p, in millimetres, or unit directions v."""

Mask = Bool[np.ndarray, "*batch"]
"""One flag an element."""

Pose = Float64[np.ndarray, "4 4"]
"""A rigid transform ``T_ab``: coordinates in b to coordinates in a, millimetres."""

Matrix3 = Float64[np.ndarray, "3 3"]
"""A rotation or a camera matrix."""

DotIndices = Int[np.ndarray, "n 2"]
"""(col, row) of dots."""

Lengths = Float64[np.ndarray, "*batch"]
"""One length an element, in millimetres."""

PixelCovariances = Float64[np.ndarray, "*batch 2 2"]
"""Covariances of pixel positions, in px squared."""

PointCovariances = Float64[np.ndarray, "*batch 3 3"]
"""Covariances of points, in mm squared."""

PointJacobians = Float64[np.ndarray, "*batch 2 3"]
"""Derivatives of a pixel position by a point, in px/mm."""
