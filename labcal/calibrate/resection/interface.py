"""A camera that looks through a flat interface into water or another medium, resected from known points."""

from dataclasses import replace

import numpy as np

from labcal.arrays import Pixels, Vectors3
from labcal.calibrate.lens_prior import PriorWidth
from labcal.calibrate.resection.placed import PlacedCamera
from labcal.calibrate.resection.problem import ResectionProblem, lens_prior
from labcal.calibrate.resection.resected import FAR, NEAR, ResectedCamera, adjusted
from labcal.cameras.camera import Camera
from labcal.cameras.lens import undistorted_dist
from labcal.cameras.window import WATER, FlatWindow
from labcal.errors import InputError
from labcal.geometry.pose_from_rays import pose_from_rays
from labcal.optim.levenberg_marquardt import minimize
from labcal.optim.stopping import Stopping
from labcal.optim.whitening import UniformNoise
from labcal.run.threads import one_blas_thread

_DISTANCE_MM = 500.0
_TILTS_DEG = ((0.0, 0.0), (20.0, 0.0), (-20.0, 0.0), (0.0, 20.0), (0.0, -20.0))
"""Initial values. From near by, or from a wrong tilt, the search often ends with the interface at the lens;
residuals before the first step do not tell from where."""
_GLANCE, _LOOK = Stopping(max_epochs=8, min_gradient=1e-3), Stopping(max_epochs=25, min_gradient=1e-3)
"""Of every start, and of the best one."""
_GLIMPSED = 0.5
"""Of the squared residuals without an interface. After the glance less than 0.2 of them is left in water, and
more than 0.8 behind waves or with a lens of another kind."""
_SHARE = 0.5
"""Of the RMS residual without an interface, above which there is none: where refraction is what the lens
formula does not explain, a tenth is left, or less."""


@one_blas_thread()
def resect_through_interface(q: Pixels, p: Vectors3, without: ResectedCamera) -> ResectedCamera | None:
    """Return the camera with a flat refractive interface in front that images points nearest to pixels.

    Parameters
    ----------
    q, p : ndarray, shapes (n, 2) and (n, 3)
        Pixels, and the world points (mm) that they see.
    without : ResectedCamera
        The camera with the same lens formula and no interface.

    Returns
    -------
    ResectedCamera or None
        None where an interface explains little of the residuals of the camera without one, or where there
        can be none: rays are parallel, or a window is known.

    Notes
    -----
    Distance, tilts and the refractive index behind the interface are adjusted with the camera (Agrawal et al.
    2012 on the geometry). Glass between air and the medium only shifts rays, by a few tenths of its
    thickness, which the distance takes up nearly whole.
    """
    camera = without.camera
    if camera.model.parallel or camera.window is not None:
        return None
    middle = without.placed.middle
    ends = [_stepped(PlacedCamera(start, middle), q, p, _GLANCE) for start in _starts(q, p, camera)]
    if not ends:
        return None
    best = min(ends, key=lambda end: _square(end.camera, q, p))
    squares = float((without.residual**2).sum())
    if not _square(best.camera, q, p) < _GLIMPSED * squares:
        return None
    best = _stepped(best, q, p, _LOOK)
    if not _square(best.camera, q, p) < _SHARE**2 * squares:
        return None
    found = adjusted(best, q, p, UniformNoise(1.0), NEAR)
    return adjusted(found.placed, q, p, UniformNoise(max(found.sigma_px, 1e-6)), NEAR)


def _starts(q: Pixels, p: Vectors3, camera: Camera) -> list[Camera]:
    """Return cameras behind interfaces to water.

    Water behind a window enlarges by about its index, so that the focal length of a camera in air is divided
    by it.
    """
    width, height = camera.size
    f = float(np.sqrt(camera.K[0, 0] * camera.K[1, 1])) / WATER
    K = np.array([[f, 0.0, 0.5 * (width - 1)], [0.0, f, 0.5 * (height - 1)], [0.0, 0.0, 1.0]])
    dist = undistorted_dist(camera.model)
    starts = []
    for tilt_x, tilt_y in _TILTS_DEG:
        window = FlatWindow(
            kind="interface",
            distance_mm=_DISTANCE_MM,
            tilt_x_deg=tilt_x,
            tilt_y_deg=tilt_y,
            thickness_mm=0.0,
            behind_index=WATER,
        )
        start = replace(camera, K=K, dist=dist, T_cam_world=np.eye(4), window=window)
        rays = start.rays(q)
        try:
            starts.append(replace(start, T_cam_world=pose_from_rays(rays.direction[rays.ok], p[rays.ok])))
        except InputError:
            continue
    return [start for start in starts if np.isfinite(_square(start, q, p))]


def _stepped(start: PlacedCamera, q: Pixels, p: Vectors3, stopping: Stopping) -> PlacedCamera:
    """Return the camera after a few steps."""
    problem = ResectionProblem(q, p, UniformNoise(1.0), lens_prior(start, p, PriorWidth.WIDE))
    return minimize(problem, start, stopping, FAR).parameters


def _square(camera: Camera, q: Pixels, p: Vectors3) -> float:
    """Return the sum of squared distances, px squared; infinite where points cannot be imaged."""
    square = float(((camera.project(p).q - q) ** 2).sum())
    return square if np.isfinite(square) else float("inf")
