"""Cross products as matrices."""

import numpy as np
from jaxtyping import Float64


def cross_matrices(v: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3 3"]:
    """Return the matrices M with M @ w equal to the cross product of v and w.

    Examples
    --------
    >>> (cross_matrices(np.array([[0.0, 0.0, 2.0]]))[0] @ [1.0, 0.0, 0.0]).tolist()
    [0.0, 2.0, 0.0]
    """
    x, y, z = v.T
    o = np.zeros(len(v))
    return np.stack([o, -z, y, z, o, -x, -y, x, o], axis=1).reshape(-1, 3, 3)
