"""Depth of a ChArUco board that slides along the view: the Z sweep of StereoComplex.

Its generator is public, so that the pair, the board and the lenses are the same: a seed of 0 draws the board
and the distortion of the two lenses, and its documentation names the rest. The board is 3 mm away, and slides
by 0.08 mm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.bench.distortion.protocols.charuco_pictures import PictureSettings, PixelRays, board_picture
from labcal.bench.distortion.protocols.protocol import Protocol, ProtocolData, Published, Quantity, rms
from labcal.bench.distortion.protocols.smooth_corners import smooth_corners
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.detect.detector import detect_dots
from labcal.detect.flags import DotFlag
from labcal.errors import InputError
from labcal.geometry.poses import pose, transform
from labcal.rng import generator
from labcal.targets.charuco import CharucoBoard, MarkerDictionary

NAME = "z-travel"
SIZE = (800, 600)
FOCAL_PX = 5937.5567 / 4.8799945
BASELINE_MM = 0.5
DISTORTIONS = (
    (-0.193388945788588, 0.0751848574080654, 0.0132081784728871, 0.0034123448245498, 0.0183597248787199),
    (0.0174499965861691, 0.1044173817090644, 0.010107313731889, -0.0159123679945553, 0.0285923421270056),
)
"""k1, k2, p1, p2, k3 of the left and the right lens."""
Z_MM = (2.96, 2.97, 2.98, 2.99, 3.00, 3.01, 3.02, 3.03, 3.04)
BOARD = CharucoBoard(
    kind="charuco",
    name="z-travel",
    squares=(14, 8),
    square_mm=0.06562967312482172,
    marker_mm=0.7 * 0.06562967312482172,
    dictionary=MarkerDictionary.DICT_4X4_1000,
)
PICTURES = PictureSettings(
    blur_px=6.0 / 2.3548200450309493 / 4.8799945, noise=0.01, slope=(0.15, 0.10), backgrounds=(0.05, 0.25)
)
_STREAM = ("bench distortion", NAME)
_UM = 1000.0
_BETWEEN_MM = 0.005
"""Half of the step from depth to depth."""
_LEAST_CORNERS = 0.9
"""Share of the board's corners that both cameras must measure, over all views."""


def cameras() -> tuple[Camera, Camera]:
    """Return the pair; the left one's frame is the world."""
    K = np.array([[FOCAL_PX, 0.0, 399.5], [0.0, FOCAL_PX, 299.5], [0.0, 0.0, 1.0]])
    left, right = (
        Camera(K, "brown5", np.array(dist), pose(np.eye(3), np.array([-x, 0.0, 0.0])), SIZE)
        for x, dist in zip((0.0, BASELINE_MM), DISTORTIONS, strict=True)
    )
    return left, right


def z_travel_data(seed: int) -> ProtocolData:
    """Return corners as they are detected: a pair of pictures a depth to learn from, and another to measure.

    Raises
    ------
    InputError
        Too few corners are detected.
    """
    return _data(seed, lambda q: q)


def refined_z_travel_data(seed: int) -> ProtocolData:
    """Return the corners of :func:`z_travel_data`, moved to a smooth surface in each picture.

    Raises
    ------
    InputError
        Too few corners are detected.
    """
    return _data(seed, lambda q: smooth_corners(BOARD.points(), q))


def _data(seed: int, refined: Callable[[np.ndarray], np.ndarray]) -> ProtocolData:
    pair = cameras()
    rays = [PixelRays.of(camera) for camera in pair]
    training, tests = (
        _Corners.joined(
            [_corners_at(z, rays, generator(seed, *_STREAM, purpose, f"{z:g}"), refined) for z in Z_MM]
        )
        for purpose in ("training", "tests")
    )
    least, whole = min(len(training.p), len(tests.p)), len(Z_MM) * BOARD.count
    if least < _LEAST_CORNERS * whole:
        raise InputError(f"Of {whole} corners, both cameras measured only {least}.")
    oracle = triangulate(pair, tests.q, tests.covariance).point
    return ProtocolData(
        X=training.q.reshape(len(training.q), -1),
        Y=training.p,
        image_sizes=(SIZE, SIZE),
        q=tests.q,
        covariance=tests.covariance,
        p=tests.p,
        group=np.searchsorted(Z_MM, tests.p[:, 2] - _BETWEEN_MM),
        oracle=oracle,
    )


def board_pose(z_mm: float) -> Float64[np.ndarray, "4 4"]:
    """Return ``T_world_target`` of the board that faces the cameras, its middle on the left one's axis."""
    R = np.diag([1.0, -1.0, -1.0])
    return pose(R, np.array([0.0, 0.0, z_mm]) - R @ BOARD.points().mean(axis=0))


def z_travel_figures(measured: Vectors3, data: ProtocolData) -> Sequence[float]:
    """Return RMS errors of corners along Z, X and Y, and of the travel from the first view to others, um."""
    error = _UM * (measured - data.p)
    views = np.array([_mean(error[data.group == number, 2]) for number in np.unique(data.group)])
    return (rms(error[:, 2]), rms(error[:, 0]), rms(error[:, 1]), rms(views[1:] - views[0]))


def _mean(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else float("nan")


@dataclass(frozen=True)
class _Corners:
    """Corners that both cameras measured."""

    q: Float64[np.ndarray, "n cameras 2"]
    covariance: Float64[np.ndarray, "n cameras 2 2"]
    p: Float64[np.ndarray, "n 3"]

    @classmethod
    def joined(cls, parts: Sequence["_Corners"]) -> "_Corners":
        """Return the corners of several views."""
        return cls(
            *(np.concatenate([getattr(one, name) for one in parts]) for name in ("q", "covariance", "p"))
        )


def _corners_at(
    z_mm: float,
    rays: Sequence[PixelRays],
    random: np.random.Generator,
    refined: Callable[[np.ndarray], np.ndarray],
) -> _Corners:
    """Return the corners of one pair of pictures."""
    found = [detected_corners(board_picture(one, BOARD, z_mm, PICTURES, random)) for one in rays]
    q = np.stack([refined(position) for position, _ in found], axis=1)
    covariance = np.stack([one for _, one in found], axis=1)
    seen = np.isfinite(q).all(axis=(1, 2))
    return _Corners(q[seen], covariance[seen], transform(board_pose(z_mm), BOARD.points())[seen])


def detected_corners(picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (count, 2) and covariances of all corners; NaN where one is not measured."""
    q, covariance = np.full((BOARD.count, 2), np.nan), np.full((BOARD.count, 2, 2), np.nan)
    found = detect_dots(picture, BOARD)
    ok = found.has_id & np.array([flag is DotFlag.OK for flag in found.flag], dtype=bool)
    at = found.index[ok, 1] * BOARD.cols + found.index[ok, 0]
    q[at], covariance[at] = found.position[ok], found.covariance[ok]
    return q, covariance


_SECONDS = 15.0
_QUANTITIES = (
    Quantity("RMS error of Z", "um"),
    Quantity("RMS error of X", "um"),
    Quantity("RMS error of Y", "um"),
    Quantity("RMS error of Z travel", "um"),
)
_SOURCE = "StereoComplex (github.com/jeffwitz/StereoComplex, commit 60b48f7), PYCASO_Z_SWEEP.md"
_SAME = (
    "the pair, the lenses, the board, the depths, the drawing of pictures, blur and noise",
    "training and test views at the same depths",
    "the error of each corner of the test views against its true place",
)
_DIFFERENT = (
    "9 pairs of pictures to learn from and 9 to measure, a depth each; theirs are 23 and 22",
    "corners are detected by labcal",
    "the noise is of another random generator",
    "travel from view to view, by the mean of all corners, is not among their figures",
)
Z_TRAVEL = Protocol(
    name=NAME,
    source=_SOURCE,
    quantities=_QUANTITIES,
    data=z_travel_data,
    figures=z_travel_figures,
    published=(
        Published("direct polynomial", "RMS error of Z", 4.31),
        Published("Soloff polynomial", "RMS error of Z", 4.37),
        Published("ray field", "RMS error of Z", 4.48),
    ),
    same=_SAME,
    different=_DIFFERENT,
    trained=len(Z_MM) * BOARD.count,
    seconds=_SECONDS,
)
"""On corners as they are detected."""
REFINED_Z_TRAVEL = Protocol(
    name=f"{NAME}-refined",
    source=_SOURCE,
    quantities=_QUANTITIES,
    data=refined_z_travel_data,
    figures=z_travel_figures,
    published=tuple(
        Published(method, f"RMS error of {axis}", value)
        for method, values in (
            ("OpenCV", (2.49, 2.44, 7.19)),
            ("direct polynomial", (0.21, 0.13, 1.47)),
            ("Soloff polynomial", (0.19, 0.13, 1.55)),
            ("ray field", (0.22, 0.14, 1.56)),
        )
        for axis, value in zip("XYZ", values, strict=True)
    ),
    same=(*_SAME, "corners are moved to a homography and a thin-plate smoothing spline before"),
    different=(
        *_DIFFERENT,
        "their OpenCV finds the poses of the board itself, from true intrinsics; our methods know them",
    ),
    trained=len(Z_MM) * BOARD.count,
    seconds=_SECONDS,
)
"""On corners that are moved to a smooth surface first."""
