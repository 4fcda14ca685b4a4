"""Depth of a ChArUco board that slides along the view: the Z sweep of StereoComplex.

Its generator is public, so that the pair, the board and the lenses are the same: a seed of 0 draws the board
and the distortion of the two lenses, and its documentation names the rest. The board is 3 mm away, and slides by
0.08 mm.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.bench.distortion.protocols.charuco_pictures import PictureSettings, PixelRays, board_picture
from labcal.bench.distortion.protocols.protocol import Protocol, ProtocolData, Published, Quantity, rms
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
_UM = 1000.0
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
    """Return corners that were detected in pictures: one pair a depth to learn from, and another to measure.

    Raises
    ------
    InputError
        Too few corners are detected.
    """
    pair = cameras()
    rays = [PixelRays.of(camera) for camera in pair]
    parts: list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]] = []
    for purpose in ("training", "tests"):
        for number, z in enumerate(Z_MM):
            names = ("bench distortion", NAME, purpose, str(number))
            found = [
                _corners(board_picture(rays[at], BOARD, z, PICTURES, generator(seed, *names, str(at))))
                for at in range(len(pair))
            ]
            q, covariance = (np.stack([one[part] for one in found], axis=1) for part in (0, 1))
            seen = np.isfinite(q).all(axis=(1, 2))
            place = transform(board_pose(z), BOARD.points())
            parts.append((q[seen], covariance[seen], place[seen], np.full(seen.sum(), number)))
    half = len(Z_MM)
    (q, _, Y, _), (tests, covariance, p, view) = (
        [np.concatenate(column) for column in zip(*some, strict=True)]
        for some in (parts[:half], parts[half:])
    )
    if min(len(Y), len(p)) < _LEAST_CORNERS * half * BOARD.count:
        raise InputError(f"Of {half * BOARD.count} corners only {min(len(Y), len(p))} are detected.")
    oracle = triangulate(pair, tests, covariance).point
    return ProtocolData(
        q.reshape(len(q), -1), Y, (SIZE, SIZE), tests, covariance, p, view.astype(np.int64), oracle
    )


def board_pose(z_mm: float) -> Float64[np.ndarray, "4 4"]:
    """Return ``T_world_target`` of the board that faces the cameras, its middle on the left one's axis."""
    R = np.diag([1.0, -1.0, -1.0])
    return pose(R, np.array([0.0, 0.0, z_mm]) - R @ BOARD.points().mean(axis=0))


def z_travel_figures(measured: Vectors3, data: ProtocolData) -> Sequence[float]:
    """Return RMS errors of corners along Z, X and Y, and of the travel from the first view to the others, um."""
    error = _UM * (measured - data.p)
    views = np.array([_mean(error[data.group == number, 2]) for number in np.unique(data.group)])
    return (rms(error[:, 2]), rms(error[:, 0]), rms(error[:, 1]), rms(views[1:] - views[0]))


def _mean(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else float("nan")


def _corners(picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (count, 2) and covariances of all corners; NaN where one is not measured."""
    q, covariance = np.full((BOARD.count, 2), np.nan), np.full((BOARD.count, 2, 2), np.nan)
    found = detect_dots(picture, BOARD)
    ok = found.has_id & np.array([flag is DotFlag.OK for flag in found.flag], dtype=bool)
    at = found.index[ok, 1] * BOARD.cols + found.index[ok, 0]
    q[at], covariance[at] = found.position[ok], found.covariance[ok]
    return q, covariance


_RAW, _REFINED = "corners as detected", "corners refined"
Z_TRAVEL = Protocol(
    name=NAME,
    source="StereoComplex, docs/PYCASO_Z_SWEEP.md (github.com/jeffwitz/StereoComplex, commit 60b48f7)",
    quantities=(
        Quantity("RMS error of Z", "um"),
        Quantity("RMS error of X", "um"),
        Quantity("RMS error of Y", "um"),
        Quantity("RMS error of Z travel", "um"),
    ),
    data=z_travel_data,
    figures=z_travel_figures,
    published=(
        Published(f"direct polynomial, {_RAW}", "RMS error of Z", 4.31),
        Published(f"Soloff polynomial, {_RAW}", "RMS error of Z", 4.37),
        Published(f"ray field, {_RAW}", "RMS error of Z", 4.48),
        *(
            Published(f"{method}, {_REFINED}", f"RMS error of {axis}", value)
            for method, values in (
                ("OpenCV", (2.49, 2.44, 7.19)),
                ("direct polynomial", (0.21, 0.13, 1.47)),
                ("Soloff polynomial", (0.19, 0.13, 1.55)),
                ("ray field", (0.22, 0.14, 1.56)),
            )
            for axis, value in zip("XYZ", values, strict=True)
        ),
    ),
    same=(
        "the pair, the lenses, the board, the depths, the drawing of pictures, blur and noise",
        "training and test views at the same depths",
        "the error of each corner of the test views against its true place",
    ),
    different=(
        "9 pairs of pictures to learn from and 9 to measure, a depth each; theirs are 23 and 22",
        "corners are as labcal detects them; those called refined were moved to a smooth surface before",
        "their OpenCV row finds the poses of the board itself, from true intrinsics; our methods know them",
        "the noise is of another random generator",
        "travel from view to view, by the mean of all corners, is not among their figures",
    ),
    trained=len(Z_MM) * BOARD.count,
)
