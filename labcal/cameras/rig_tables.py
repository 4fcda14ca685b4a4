"""A rig as a table of pandas, and as arrays of xarray."""

from typing import TYPE_CHECKING

import numpy as np

from labcal.cameras.rig import Rig
from labcal.extras import optional_module

if TYPE_CHECKING:
    import pandas
    import xarray


def rig_frame(rig: Rig) -> "pandas.DataFrame":
    """Return a table with a line a camera; see :meth:`~labcal.cameras.rig.Rig.to_pandas`."""
    lines = []
    for name in rig.cameras:
        camera = rig.camera(name)
        fx, fy, cx, cy = camera.intrinsics
        lines.append(
            (name, camera.lens, *camera.size, fx, fy, cx, cy, *camera.centre.tolist(), camera.dist.tolist())
        )
    columns = (
        "camera", "lens", "width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px",
        "X_mm", "Y_mm", "Z_mm", "dist",
    )  # fmt: skip
    frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(lines, columns=list(columns))
    return frame


def rig_dataset(rig: Rig) -> "xarray.Dataset":
    """Return named arrays; see :meth:`~labcal.cameras.rig.Rig.to_xarray`.

    Coefficients are padded with zeros to the most that a camera of the rig has, as OpenCV does.
    """
    cameras = [rig.camera(name) for name in rig.cameras]
    most = max(len(camera.dist) for camera in cameras)
    dist = np.array([[*camera.dist, *(0.0,) * (most - len(camera.dist))] for camera in cameras])
    found: xarray.Dataset = optional_module("xarray", "data").Dataset(
        {
            "K": (("camera", "row3", "column3"), np.stack([camera.K for camera in cameras]), _PX),
            "dist": (("camera", "coefficient"), dist),
            "T_cam_world": (
                ("camera", "row4", "column4"),
                np.stack([camera.T_cam_world for camera in cameras]),
                {"units": "mm", "long_name": "world to camera: rotation, and translation in mm"},
            ),
            "size": (("camera", "extent"), np.array([camera.size for camera in cameras]), _PX),
        },
        coords={
            "camera": list(rig.cameras),
            "lens": ("camera", [camera.lens for camera in cameras]),
            "extent": ["width", "height"],
        },
        attrs={"calibrated_on": list(rig.calibrated_on)},
    )
    return found


_PX = {"units": "px"}
