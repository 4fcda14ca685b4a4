"""Families of camera pairs on which methods are compared, each with its volume."""

from collections.abc import Mapping
from dataclasses import dataclass

from labcal.bench.families import cameras
from labcal.bench.families.cameras import BROWN_REFERENCE, SIZE, WEBCAM, CameraAt
from labcal.bench.families.registry import camera_pair
from labcal.bench.families.volume import ROOM, TABLE, Volume
from labcal.cameras.camera import Camera
from labcal.cameras.window import WATER

__all__ = ["FAMILIES", "SIZE", "Family"]


@dataclass(frozen=True)
class Family:
    """One family of cameras.

    Attributes
    ----------
    camera : callable
        From the pose ``T_cam_world``, the seed and the camera's number to the true camera.
    volume : Volume
    right : mapping, optional
        Parameters of ``bundle`` that make it the right family; None where there is none.
    parametric : bool
        Whether one of the lens models that ``hybrid`` chooses among can be right.
    """

    name: str
    camera: CameraAt
    volume: Volume
    right: Mapping[str, str | float] | None
    parametric: bool

    def pair(self, seed: int) -> tuple[Camera, Camera]:
        """Return both cameras."""
        return camera_pair(self.camera, seed)


FAMILIES = (
    Family("pinhole", cameras.pinhole(), TABLE, {"lens": "pinhole"}, parametric=True),
    Family("brown", cameras.brown(BROWN_REFERENCE), TABLE, {"lens": "brown5"}, parametric=True),
    Family("rational", cameras.rational(1.0), TABLE, {"lens": "rational8"}, parametric=True),
    Family("fisheye", cameras.fisheye(1.0), ROOM, {"lens": "fisheye-kb4"}, parametric=True),
    Family("webcam", cameras.prescribed(1.0), TABLE, {"lens": WEBCAM}, parametric=False),
    Family("wavy pane", cameras.behind_waves(1.0), TABLE, None, parametric=False),
    Family(
        "water", cameras.in_water(1.0), TABLE, {"lens": "pinhole", "behind_index": WATER}, parametric=False
    ),
)
