"""The families by name; a new one is a line here."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from labcal.arguments import one_named
from labcal.bench.families import cameras
from labcal.bench.families.cameras import CameraAt
from labcal.bench.families.volume import TABLE, Volume
from labcal.cameras.camera import Camera
from labcal.geometry.poses import look_at

EYES_MM = ((650.0, 700.0, 2400.0), (1350.0, 700.0, 2400.0))
LOOK_AT_MM = (1000.0, 1000.0, 500.0)


@dataclass(frozen=True)
class Family:
    """Camera pairs that depart from the pinhole the more, the greater their strength.

    Attributes
    ----------
    camera : callable
        From the strength, 0 for a pinhole to 1, to the true cameras.
    known_as : callable
        From the strength to a figure that people know: a coefficient, degrees, pixels.
    volume : callable
        From the strength to the volume that the cameras look at.
    """

    name: str
    camera: Callable[[float], CameraAt]
    known_as: Callable[[float], str]
    volume: Callable[[float], Volume] = lambda _strength: TABLE

    def pair(self, strength: float, seed: int) -> tuple[Camera, Camera]:
        """Return both cameras."""
        return camera_pair(self.camera(strength), seed)


def camera_pair(camera: CameraAt, seed: int) -> tuple[Camera, Camera]:
    """Return cameras at the two places from which all families look at their volume."""
    up = np.array([0.0, 1.0, 0.0])
    first, second = (look_at(np.array(eye), np.array(LOOK_AT_MM), up) for eye in EYES_MM)
    return camera(first, seed, 0), camera(second, seed, 1)


def _field(widest_deg: float) -> Callable[[float], str]:
    return lambda strength: f"{2.0 * cameras.fisheye_half_field(strength, widest_deg):.0f} degrees"


_LENSES = (
    Family("brown", cameras.brown, lambda s: f"k1 {0.0 - 0.5 * s:.3g}"),
    Family("rational", cameras.rational, lambda s: f"k1 {0.0 - 0.35 * s:.3g}, k4 {0.3 * s:.3g}"),
    Family("fisheye", cameras.fisheye, _field(cameras.FISHEYE_DEG), cameras.fisheye_volume),
    Family("double-sphere", cameras.double_sphere, _field(cameras.SPHERE_DEG), cameras.fisheye_volume),
    Family("prescription", cameras.prescribed, lambda s: f"curvatures {s:.3g} of the webcam lens"),
    Family("wavy-pane", cameras.behind_waves, lambda s: f"3 waves of {cameras.AMPLITUDE_PX * s:.3g} px"),
    Family(
        "water",
        cameras.in_water,
        lambda s: f"index {cameras.index_behind(s):.3f}, tilt {cameras.TILT_DEG * s:.3g} deg",
    ),
)
FAMILIES = {family.name: family for family in _LENSES}


def family_by_name(name: str) -> Family:
    """Return a family.

    Raises
    ------
    UnknownNameError
        There is none of that name; the nearest one is offered.
    """
    return one_named(FAMILIES, "family", name)
