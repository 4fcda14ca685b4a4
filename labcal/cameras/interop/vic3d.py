"""The cameras in a project file of VIC-3D (``z3d`` or ``calibration.xml``); read only.

A camera holds eight numbers, cx cy fx fy fs kappa1 kappa2 kappa3, and an orientation alpha beta gamma tx ty
tz that maps world to camera (degrees, millimetres; R = Rz(gamma) Ry(beta) Rx(alpha)), as DICe reads them. The
formula of the kappas is not published: DICe's source takes k1 r + k2 r^2 for it, leaves k3 out and says that
this is a guess, and other readers of its files refuse it or copy the guess. So a camera with
distortion or skew is refused. The size of the pictures stands at the polygon of the first area of interest.
"""

from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from labcal.cameras.interop.exchange import ReadRig
from labcal.cameras.interop.lens_parameters import camera_record, perspective_lens
from labcal.cameras.interop.numbers_text import finite_numbers, known_size
from labcal.cameras.interop.placement import rig_of
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError
from labcal.geometry.poses import from_fixed_angles_deg, pose

PROJECT = "project"
"""The outermost element."""
_NUMBERS, _ORIENTATION = 8, 6


def read_project(root: Element, path: Path, stated: tuple[int, int] | None) -> ReadRig:
    """Return the cameras of a project; `stated` is the size of the pictures where the project has none, px.

    Raises
    ------
    InputError
        There are none, they have distortion or skew, or nothing determines how large the pictures are.
    """
    cameras = list(root.iter("camera"))
    mask = next(root.iter("polygonmask"), None)
    if not cameras:
        raise InputError(f"{path} is a project of VIC-3D without a calibration.")
    if mask is None and stated is None:
        raise InputError(
            f"{path} does not state how large the pictures are: the project has no area of interest. Draw "
            "one, save, and convert again, or give it: `size='1280x960'`."
        )
    size = known_size(None if mask is None else [mask.get("width"), mask.get("height")], stated, path)
    names: list[str] = []
    records: list[CameraRecord] = []
    for camera in cameras:
        name = f"camera-{camera.get('id', len(names))}"
        cx, cy, fx, fy, *bent = finite_numbers((camera.text or "").split(), (_NUMBERS,), name, path)
        if any(bent):
            raise InputError(
                f"{path}: {name} has skew or distortion (fs kappa1 kappa2 kappa3 = {bent}). VIC-3D does not "
                "publish the formula (whether they shift ideal or measured places, by which powers, in which "
                "unit), and the programs that read its files guess it. Calibrate from the same pictures with "
                "labcal, or with MatchID, DICe or OpenCV, whose files are read."
            )
        element = camera.find("orientation")
        words = [] if element is None else (element.text or "").split()
        angles = finite_numbers(words, (_ORIENTATION,), f"the orientation of {name}", path)
        R = from_fixed_angles_deg(angles[:3])
        T_cam_world = pose(R, np.array(angles[3:]))
        names.append(name)
        records.append(camera_record((fx, fy, cx, cy), perspective_lens(()), T_cam_world, size, path))
    return ReadRig(rig_of(names, records))
