"""A protocol of others: its data, its figures, and the figures that its authors published."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Lengths, Vectors3

LOOSE = -1
"""Group of a point that belongs to no length and no view."""


@dataclass(frozen=True)
class ProtocolData:
    """Training and test data of a protocol for one seed.

    Attributes
    ----------
    X : float64 array, (n, 2 x cameras)
        Pixels of training points, px.
    Y : float64 array, (n, 3)
        Training points, mm.
    image_sizes : tuple of (int, int)
        Width and height of each camera's pictures, px.
    q : float64 array, (m, cameras, 2)
        Pixels of test points, px.
    covariance : float64 array, (m, cameras, 2, 2)
        Of these pixels, px squared.
    p : float64 array, (m, 3)
        Test points, mm.
    group : int64 array, (m,)
        Number of the length or of the view that a test point belongs to, or `LOOSE`.
    oracle : float64 array, (m, 3)
        Triangulated from `q` with the true cameras, mm.
    """

    X: Float64[np.ndarray, "n inputs"]
    Y: Float64[np.ndarray, "n 3"]
    image_sizes: tuple[tuple[int, int], ...]
    q: Float64[np.ndarray, "m cameras 2"]
    covariance: Float64[np.ndarray, "m cameras 2 2"]
    p: Float64[np.ndarray, "m 3"]
    group: Int64[np.ndarray, " m"]
    oracle: Float64[np.ndarray, "m 3"]


@dataclass(frozen=True)
class Quantity:
    """A figure of a protocol.

    Attributes
    ----------
    name : str
        As in tables and files.
    unit : str
        ``"mm"``, ``"um"``, or ``"1"`` of a share.
    """

    name: str
    unit: str


@dataclass(frozen=True)
class Published:
    """A figure that the authors of a protocol published.

    Attributes
    ----------
    method : str
        Their method, in their words.
    quantity : str
        Name of the quantity that it is compared with.
    value : float
        In the unit of the quantity.
    words : str
        Their statement where a number alone would say too much, as "at most".
    """

    method: str
    quantity: str
    value: float
    words: str = ""


@dataclass(frozen=True)
class Protocol:
    """A protocol of others.

    Attributes
    ----------
    name : str
    source : str
        The publication.
    quantities : tuple of Quantity
        Its figures, in the order of `figures`.
    data : callable
        From a seed to training and test data.
    figures : callable
        From measured points (m, 3), NaN where there are none, and the data to the values of the quantities.
    published : tuple of Published
    same, different : tuple of str
        What is as in the publication, and what is not or is not known.
    trained : int
        Number of training points, roughly; it determines the cost of methods.
    seconds : float
        Cost of the data, roughly.
    """

    name: str
    source: str
    quantities: tuple[Quantity, ...]
    data: Callable[[int], ProtocolData]
    figures: Callable[[Vectors3, ProtocolData], Sequence[float]]
    published: tuple[Published, ...]
    same: tuple[str, ...]
    different: tuple[str, ...]
    trained: int
    seconds: float = 0.0


def rms(values: Lengths) -> float:
    """Return the root mean square of what is finite; NaN of nothing."""
    known = values[np.isfinite(values)]
    return float(np.sqrt((known**2).mean())) if len(known) else float("nan")
