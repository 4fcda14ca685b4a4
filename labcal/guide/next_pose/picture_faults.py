"""Faults of a set of pictures, seen on the spot: not found and why, light, blur, a pose taken before."""

from collections.abc import Mapping

import numpy as np

from labcal.arrays import Pose, Vectors3
from labcal.capture.source import Frame
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag
from labcal.geometry.poses import inverse, rotation_vector
from labcal.shoot.quality import picture_quality

BURNT_OUT = 0.02
"""Share of a picture at full scale from which on its light is worth a word."""
DARK = 0.04
"""Median level below which a picture is dark."""
_SOFT = 0.6
"""Of the sharpest picture of its camera, below which a picture is blurred."""
_LOST = 0.2
"""Share of the dots with one flag that is worth a word."""
REPEATED_DEG, REPEATED_SHARE = 4.0, 0.04
"""Turn, and move as a share of the distance, within which a pose is one that was taken before."""
_WORDS = {
    DotFlag.BLURRED: "blurred: hold the target still, or nearer to where the camera is in focus",
    DotFlag.SATURATED: "burnt out: lessen light or exposure",
}


def picture_faults(
    frames: Mapping[str, Frame], found: Mapping[str, PictureDots], sharpest: dict[str, float]
) -> list[str]:
    """Return the faults of each picture of a set, each naming its camera.

    Parameters
    ----------
    frames, found : mapping
        By camera.
    sharpest : dict of str to float
        Sharpness of the sharpest picture so far by camera, 1/px; brought up to date.
    """
    faults = []
    for name, frame in frames.items():
        dots, quality = found[name], picture_quality(frame.picture)
        if dots.refusal is not None:
            faults.append(f"camera {name}: {dots.why}")
        sharp = quality.sharpness
        if np.isfinite(sharp):
            sharpest[name] = max(sharp, sharpest.get(name, 0.0))
            if sharp < _SOFT * sharpest[name]:
                faults.append(
                    f"camera {name}: less sharp than its sharpest picture. Hold the target still, or nearer "
                    "to where the camera is in focus."
                )
        if quality.saturated_share > BURNT_OUT:
            faults.append(
                f"camera {name}: {100.0 * quality.saturated_share:.0f}% of the picture is burnt out. Lessen "
                "light or exposure."
            )
        elif quality.median_level < DARK:
            faults.append(f"camera {name}: the picture is dark. Give more light or exposure.")
        faults += [
            f"camera {name}: dots are {words}."
            for flag, words in _WORDS.items()
            if dots.flag and sum(one is flag for one in dots.flag) > _LOST * len(dots.flag)
        ]
    return faults


def repeated(poses: Mapping[str, Pose], view: str, middle: Vectors3) -> str | None:
    """Return the name of an earlier view whose pose a view repeats; None where it is new.

    Parameters
    ----------
    poses : mapping of str to ndarray, shape (4, 4)
        By view, in the order in which they were taken, mm; the cameras are near the origin.
    view : str
    middle : ndarray, shape (3,)
        Of the target in its frame, mm.
    """
    T = poses.get(view)
    if T is None:
        return None
    place = T[:3, :3] @ middle + T[:3, 3]
    for name, other in poses.items():
        if name == view:
            break
        turned = np.degrees(np.linalg.norm(rotation_vector(inverse(other) @ T)))
        moved = np.linalg.norm(other[:3, :3] @ middle + other[:3, 3] - place) / np.linalg.norm(place)
        if turned < REPEATED_DEG and moved < REPEATED_SHARE:
            return name
    return None
