"""Cameras of one pose that depart from the pinhole by a strength from 0 to 1."""

from collections.abc import Callable

import numpy as np

from labcal.arrays import Pose
from labcal.bench.families.volume import ROOM, TABLE, Volume
from labcal.cameras.camera import Camera
from labcal.cameras.lens import DOUBLE_SPHERE, LENSES, PRESCRIPTION
from labcal.cameras.mathematics import NUMPY
from labcal.cameras.prescription import Prescription, load_prescription
from labcal.cameras.window import GLASS, WATER, FlatWindow, Wave, WavyWindow
from labcal.rng import generator

SIZE = (1280, 960)
FOCAL_PX = 1000.0
WEBCAM = "webcam-doublet"
_NO_LENS = np.zeros(5)

CameraAt = Callable[[Pose, int, int], Camera]
"""From the pose ``T_cam_world``, the seed and the camera's number to the true camera."""

# k1 is -0.3 at the strength 0.6, the camera of `labcal bench solve`; the others follow.
BROWN_REFERENCE = 0.6
_K1, _K2, _P1, _P2 = -0.3, 0.09, 0.0006, -0.0004
_RATIONAL = np.array([-0.35, 0.12, 0.0006, -0.0004, 0.02, 0.3, 0.1, 0.02])
_FISHEYE = np.array([0.02, -0.004, 0.001, 0.0])
_TANGENT = np.array([1.0 / 3.0, 2.0 / 15.0, 17.0 / 315.0, 62.0 / 2835.0])
"""Of the series of the tangent, which is the pinhole's radius."""
_XI, _ALPHA = -0.2, 0.6
_HALF_WIDTH = 0.5 * SIZE[0]
_FLAT_DEG = float(np.degrees(np.arctan(_HALF_WIDTH / FOCAL_PX)))
FISHEYE_DEG, SPHERE_DEG = 75.0, 85.0
"""Half the field of view across the picture's width, at the strength 1."""
_WAVES, AMPLITUDE_PX, PERIOD_PX = 3, 3.0, 300.0
_DISTANCE_MM, TILT_DEG, _THICKNESS_MM = 200.0, 30.0, 10.0
_NEAREST_MM = 1400.0
"""From the cameras to the nearest face of the volume."""


def pinhole() -> CameraAt:
    """Return cameras without distortion."""
    return _lens("pinhole", _NO_LENS)


def brown(strength: float) -> CameraAt:
    """Return cameras with barrel distortion: k1 from 0 to -0.5, with the k2 that keeps it monotonic."""
    share = strength / BROWN_REFERENCE
    return _lens("brown5", np.array([_K1 * share, _K2 * share**2, _P1 * share, _P2 * share, 0.0]))


def rational(strength: float) -> CameraAt:
    """Return cameras whose distortion is a fraction of polynomials."""
    return _lens("rational8", _RATIONAL * strength)


def fisheye_half_field(strength: float, widest_deg: float) -> float:
    """Return half the field of view (deg) across the picture, between the pinhole's and the widest."""
    return _FLAT_DEG * (1.0 - strength) + widest_deg * strength


def fisheye(strength: float) -> CameraAt:
    """Return cameras between the pinhole and an equidistant fisheye, with a field that grows to 150 degrees.

    The lens model is a polynomial, which is not quite the tangent: without strength it is the pinhole itself.
    """
    if strength == 0.0:
        return pinhole()
    angle = np.radians(fisheye_half_field(strength, FISHEYE_DEG))
    dist = np.zeros(5)
    dist[:4] = (1.0 - strength) * _TANGENT + strength * _FISHEYE
    radius = (1.0 - strength) * np.tan(angle) + strength * angle
    return _lens("fisheye-kb4", dist, _HALF_WIDTH / float(radius))


def double_sphere(strength: float) -> CameraAt:
    """Return cameras with a double-sphere lens, with a field that grows to 170 degrees."""
    xi, alpha = _XI * strength, _ALPHA * strength
    angle = np.radians(fisheye_half_field(strength, SPHERE_DEG))
    radius, _ = LENSES[DOUBLE_SPHERE].distort(NUMPY, (xi, alpha), float(np.tan(0.5 * angle)), 0.0)
    return _lens(DOUBLE_SPHERE, np.array([xi, alpha, 0.0, 0.0, 0.0]), _HALF_WIDTH / float(radius))


def fisheye_volume(strength: float) -> Volume:
    """Return the volume that fills the growing picture: the angle of its rim grows with the strength."""
    narrow, wide = (
        np.arctan(0.5 * (volume.high[0] - volume.low[0]) / _NEAREST_MM) for volume in (TABLE, ROOM)
    )
    rim = np.tan(narrow * (1.0 - strength) + wide * strength)
    return TABLE.towards(ROOM, float((rim - np.tan(narrow)) / (np.tan(wide) - np.tan(narrow))))


def prescribed(strength: float) -> CameraAt:
    """Return cameras with the glass of a webcam's lens, its surfaces flatter the smaller the strength.

    In the limit of flat surfaces the rays through the middle of the stop leave as they came: a pinhole.
    """
    if strength == 0.0:
        return pinhole()
    glass = flattened(load_prescription(WEBCAM), strength)
    return lambda T_cam_world, _seed, _number: Camera(
        _matrix(FOCAL_PX), PRESCRIPTION, _NO_LENS, T_cam_world, SIZE, glass
    )


def flattened(glass: Prescription, share: float) -> Prescription:
    """Return a prescription with all curvatures multiplied by a share."""
    if share == 1.0:
        return glass
    surfaces = tuple(
        surface
        if surface.radius_mm is None
        else surface.model_copy(update={"radius_mm": surface.radius_mm / share})
        for surface in glass.surfaces
    )
    return glass.model_copy(update={"surfaces": surfaces})


def behind_waves(strength: float) -> CameraAt:
    """Return cameras behind wavy glass; the waves differ between the cameras and the seeds."""

    def camera(T_cam_world: Pose, seed: int, number: int) -> Camera:
        random = generator(seed, "bench solve", "waves", str(number))
        waves, amplitude_px = [], AMPLITUDE_PX * strength
        for _ in range(_WAVES):
            turn, direction, phase = random.uniform(0.0, 360.0, 3)
            amplitude = (
                float(amplitude_px * np.cos(np.radians(turn))),
                float(amplitude_px * np.sin(np.radians(turn))),
            )
            waves.append(
                Wave(
                    amplitude_px=amplitude,
                    period_px=PERIOD_PX,
                    direction_deg=float(direction),
                    phase_deg=phase,
                )
            )
        window = WavyWindow(waves=tuple(waves))
        return Camera(_matrix(FOCAL_PX), "pinhole", _NO_LENS, T_cam_world, SIZE, window=window)

    return camera


def index_behind(strength: float) -> float:
    """Return the refractive index of what the points are in: from that of air to that of water."""
    return 1.0 + (WATER - 1.0) * strength if strength < 1.0 else WATER


def in_water(strength: float) -> CameraAt:
    """Return cameras behind a window whose tilt, thickness and refraction grow with the strength."""
    window = FlatWindow(
        distance_mm=_DISTANCE_MM,
        tilt_x_deg=TILT_DEG * strength,
        thickness_mm=_THICKNESS_MM * strength,
        glass_index=1.0 + (GLASS - 1.0) * strength if strength < 1.0 else GLASS,
        behind_index=index_behind(strength),
    )
    return lambda T_cam_world, _seed, _number: Camera(
        _matrix(FOCAL_PX), "pinhole", _NO_LENS, T_cam_world, SIZE, window=window
    )


def _matrix(f: float) -> np.ndarray:
    return np.array([[f, 0.0, 640.3], [0.0, f, 478.2], [0.0, 0.0, 1.0]])


def _lens(name: str, dist: np.ndarray, f: float = FOCAL_PX) -> CameraAt:
    return lambda T_cam_world, _seed, _number: Camera(_matrix(f), name, dist, T_cam_world, SIZE)
