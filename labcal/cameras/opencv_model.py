"""The lens models of OpenCV, whose coefficients most file formats hold, and how a lens's own relate to it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class OpenCVModel:
    """One of OpenCV's lens models.

    A lens of labcal is one of them if its coefficients bear the same names and mean the same; their order is
    the lens's own business.
    """

    function: str
    """The function of OpenCV that projects with it."""
    order: tuple[str, ...]
    """The names of its coefficients in OpenCV's order."""


PERSPECTIVE = OpenCVModel(
    "cv2.projectPoints",
    ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"),
)
FISHEYE = OpenCVModel("cv2.fisheye.projectPoints", ("k1", "k2", "k3", "k4"))


def to_order(model: OpenCVModel, names: tuple[str, ...], dist: tuple[float, ...]) -> tuple[float, ...]:
    """Return coefficients in OpenCV's order, as many as reach to the last one that the lens has.

    Parameters
    ----------
    model : OpenCVModel
    names : tuple of str
        The lens's coefficients in its own order, all of them names of the model.
    dist : tuple of float
        At least as many; what is behind them means nothing.
    """
    values = dict(zip(names, dist, strict=False))
    held = max((model.order.index(name) + 1 for name in names), default=0)
    return tuple(values.get(name, 0.0) for name in model.order[:held])


def from_order(model: OpenCVModel, names: tuple[str, ...], values: tuple[float, ...]) -> tuple[float, ...]:
    """Return a lens's coefficients, in its own order, from OpenCV's; 0 where `values` end before."""
    by_name = dict(zip(model.order, values, strict=False))
    return tuple(by_name.get(name, 0.0) for name in names)
