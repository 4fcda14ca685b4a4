"""The volume of 100 x 100 x 1000 mm in which a network was measured in JOSA A 40:337 (2023).

Only the abstract is known to us. It names the volume, the greatest errors and the scatter of 1000 mm, and no
cameras; these are chosen here: the near end of the volume fills the picture, and both cameras see all of it.
"""

from collections.abc import Sequence

import numpy as np

from labcal.arrays import Vectors3
from labcal.bench.distortion.protocols.protocol import (
    LOOSE,
    Protocol,
    ProtocolData,
    Published,
    Quantity,
    rms,
)
from labcal.bench.families.cameras import BROWN_REFERENCE, FOCAL_PX, SIZE
from labcal.bench.families.cameras import brown as brown_cameras
from labcal.bench.families.volume import Volume
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.geometry.poses import look_at
from labcal.rng import generator

NAME = "josa-volume"
LENGTH_MM, SIDE_MM = 1000.0, 100.0
VOLUME = Volume((0.0, 0.0, 0.0), (SIDE_MM, SIDE_MM, LENGTH_MM))
ALLOWED_MM = 2.5
"""The error that is "rarely" exceeded."""
NOISE_PX = 0.1
"""Of each coordinate: that of a good detector of chessboard corners."""
PLANES, DOTS = 11, 7
"""Planes across z, 100 mm apart, each with 7 x 7 points."""
POINTS, LENGTHS = 1000, 200
_EYES_MM = ((10.0, 50.0, 1500.0), (90.0, 50.0, 1500.0))
_LOOK_AT_MM = (50.0, 50.0, 750.0)
_LONGER = 4.0
"""Focal length over that of the families, 1000 px: the picture is as wide as the near end of the volume."""


def cameras() -> tuple[Camera, Camera]:
    """Return the pair: 80 mm apart, 500 mm before the volume.

    The lens shifts every pixel as that of the family `brown` at k1 = -0.3 does: the coefficients follow from
    the focal length.
    """
    return _camera(0), _camera(1)


def _camera(number: int) -> Camera:
    T_cam_world = look_at(np.array(_EYES_MM[number]), np.array(_LOOK_AT_MM), np.array([0.0, 1.0, 0.0]))
    short = brown_cameras(BROWN_REFERENCE)(T_cam_world, 0, number)
    powers = np.array([2.0, 4.0, 1.0, 1.0, 6.0])  # of a radius in the unit of the focal length
    K = short.K.copy()
    K[0, 0] = K[1, 1] = _LONGER * FOCAL_PX
    return Camera(K, short.lens, short.dist * _LONGER**powers, T_cam_world, SIZE)


def josa_data(seed: int) -> ProtocolData:
    """Return noisy pixels of training points on planes, of random points, and of the ends of lengths.

    The lengths run from the far face of the volume to the near one.
    """
    pair = cameras()
    Y = _planes()
    random = generator(seed, "bench distortion", NAME, "tests")
    loose, foot = VOLUME.points(POINTS, random), VOLUME.points(LENGTHS, random)
    foot[:, 2] = 0.0
    p = np.concatenate([loose, foot, foot + np.array([0.0, 0.0, LENGTH_MM])])
    group = np.concatenate([np.full(POINTS, LOOSE), np.tile(np.arange(LENGTHS), 2)])
    X = _noisy(pair, Y, generator(seed, "bench distortion", NAME, "training")).reshape(len(Y), -1)
    q = _noisy(pair, p, random)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(p), len(pair), 1, 1))
    oracle = triangulate(pair, q, covariance).point
    return ProtocolData(X, Y, (SIZE, SIZE), q, covariance, p, group, oracle)


def josa_figures(measured: Vectors3, data: ProtocolData) -> Sequence[float]:
    """Return errors of random points and of lengths; a point that is not measured counts as a large error."""
    is_loose = data.group == LOOSE
    error = np.linalg.norm(measured[is_loose] - data.p[is_loose], axis=1)
    above = float((~(error <= ALLOWED_MM)).mean())
    foot, head = measured[~is_loose].reshape(2, -1, 3)
    length = np.linalg.norm(head - foot, axis=1)
    length = length[np.isfinite(length)] - LENGTH_MM
    known = error[np.isfinite(error)]
    nan = float("nan")
    return (
        above,
        float(known.max()) if len(known) else nan,
        rms(error),
        float(length.std(ddof=1)) if len(length) > 1 else nan,
        float(length.mean()) if len(length) else nan,
    )


def _planes() -> Vectors3:
    axes = [np.linspace(0.0, SIDE_MM, DOTS)] * 2 + [np.linspace(0.0, LENGTH_MM, PLANES)]
    return np.stack([one.ravel() for one in np.meshgrid(*axes, indexing="ij")], axis=1)


def _noisy(pair: Sequence[Camera], p: Vectors3, random: np.random.Generator) -> np.ndarray:
    exact = np.stack([camera.project(p).q for camera in pair], axis=1)
    return exact + NOISE_PX * random.standard_normal(exact.shape)


_NETWORK = "network from pixels to points"
JOSA_VOLUME = Protocol(
    name=NAME,
    source="J. Opt. Soc. Am. A 40(2):337-354 (2023), doi:10.1364/JOSAA.469332, abstract",
    quantities=(
        Quantity(f"share of errors above {ALLOWED_MM:g} mm", "1"),
        Quantity("greatest error", "mm"),
        Quantity("RMS error", "mm"),
        Quantity("standard deviation of lengths of 1000 mm", "mm"),
        Quantity("mean error of lengths of 1000 mm", "mm"),
    ),
    data=josa_data,
    figures=josa_figures,
    published=(
        Published(
            _NETWORK,
            "greatest error",
            ALLOWED_MM,
            "the absolute error rarely exceeds it; how rarely is not said",
        ),
        Published(
            _NETWORK,
            "standard deviation of lengths of 1000 mm",
            1.5,
            "does not exceed it, for 1000 mm distance measurement",
        ),
    ),
    same=(
        "a volume of 100 x 100 x 1000 mm, with two cameras",
        "methods learn from points on a board whose places are known, and are measured on others",
    ),
    different=(
        "theirs are photographs of a chessboard, ours simulated points with 0.1 px of noise",
        "their cameras are not named in the abstract; ours have 1280 x 960 px and a focal length of 4000 px",
        "ours are 80 mm apart and 500 to 1500 mm away, with the distortion in pixels of k1 = -0.3 at 1000 px",
        "an absolute error may be one coordinate's; ours is the length of the error in 3-D",
        "their 1000 mm may be a distance from the cameras; ours are lengths along z, measured end to end",
        f"{PLANES * DOTS**2} training points on {PLANES} planes; the number of theirs is not in the abstract",
    ),
    trained=PLANES * DOTS**2,
)
