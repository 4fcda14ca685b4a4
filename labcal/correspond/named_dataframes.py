"""Named pixels and named points as tables of pandas."""

from typing import TYPE_CHECKING

from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_pixels_csv import HEADER as PIXELS
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.named_points_csv import HEADER as POINTS
from labcal.correspond.points_csv import UPPER
from labcal.extras import optional_module

if TYPE_CHECKING:
    import pandas


def pixels_frame(pixels: NamedPixels) -> "pandas.DataFrame":
    """Return the columns of ``pixels.csv``; see :meth:`NamedPixels.to_pandas`."""
    upper = pixels.covariance.reshape(-1, 4)[:, [0, 1, 3]]
    columns = (pixels.view, pixels.camera, pixels.point, *pixels.position.T, *upper.T)
    frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(
        dict(zip(PIXELS, columns, strict=True))
    )
    return frame


def named_points_frame(points: NamedPoints) -> "pandas.DataFrame":
    """Return the columns of ``points.csv``; see :meth:`NamedPoints.to_pandas`."""
    upper = points.covariance[:, UPPER[0], UPPER[1]]
    columns = (points.view, points.name, *points.point.T, *upper.T, points.flag)
    frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(
        dict(zip(POINTS, columns, strict=True))
    )
    return frame
