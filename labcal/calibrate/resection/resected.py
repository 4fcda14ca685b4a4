"""A camera found from points in space, and how sure it is."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.lens_prior import FoundLens, PriorWidth, narrow_is_better
from labcal.calibrate.perspectivity import Perspectivity, Sight, parallel_error, refuse_endless
from labcal.calibrate.resection.placed import PlacedCamera
from labcal.calibrate.resection.problem import ResectionProblem, lens_prior
from labcal.calibrate.resection.start import parallel_start, resection_starts
from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENSES, TELECENTRIC, undistorted_dist
from labcal.errors import InputError
from labcal.geometry.arrangement import refuse_collinear, refuse_few, refuse_one_plane
from labcal.geometry.poses import transform
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize
from labcal.optim.stopping import Stopping
from labcal.optim.whitening import UniformNoise, Whitening
from labcal.run.threads import one_blas_thread

_STOPPING = Stopping(max_epochs=200, min_gradient=1e-3)
FAR, NEAR = Damping(ceiling=1e8), Damping(start=1e-6, ceiling=1e8)
"""The first damping, from anywhere and from a camera that is nearly right already."""
_MOST_OFF_PARALLEL = 0.02
"""RMS residual of parallel rays without distortion, as a share of the picture's width, beyond which rays meet
for certain: no telecentric lens distorts so much."""
MOST_OFF = 0.05
"""RMS residual, as a share of the picture's width, from which on it is not the camera of these dots."""


@dataclass(frozen=True)
class ResectedCamera:
    """The end of a resection.

    Attributes
    ----------
    placed : PlacedCamera
    covariance : float64 array, (free, free)
        Of pose and free parameters.
    residual : float64 array, (n, 2)
        Predicted minus measured, px.
    sigma_px : float
        What residuals scatter along each axis, by as many degrees of freedom as are left.
    held : PriorWidth
        Of the prior of the lens's coefficients.
    """

    placed: PlacedCamera
    covariance: Float64[np.ndarray, "free free"]
    residual: Float64[np.ndarray, "n 2"]
    sigma_px: float
    held: PriorWidth = PriorWidth.WIDE

    @property
    def camera(self) -> Camera:
        """The camera."""
        return self.placed.camera

    def lens(self, whitening: Whitening) -> FoundLens:
        """Return the camera with the covariance of its coefficients, by the scatter of its residuals."""
        own = self.placed.free_parameters.coefficients
        at = slice(POSE + own.start, POSE + own.stop)
        freedom = max(1, self.residual.size - self.placed.count)
        scatter = float((whitening.whiten(self.residual) ** 2).sum()) / freedom
        return FoundLens(self.camera, scatter * self.covariance[at, at])


@one_blas_thread()
def resect(method: str, q: Pixels, p: Vectors3, *kinds: Camera) -> ResectedCamera:
    """Return the camera that images points nearest to pixels.

    Parameters
    ----------
    method : str
        For messages.
    q : ndarray, shape (n, 2)
        Pixels.
    p : ndarray, shape (n, 3)
        World points, mm, not all on one plane.
    *kinds : Camera
        Size, lens, prescription and window; numbers do not matter, but for the place of a flat window, which
        is where the search for it begins. Several kinds are the same one with windows at several places.

    Raises
    ------
    InputError
        Too few points, all on a plane, or no such camera images them anywhere near the pixels; or the rays
        are parallel, and those of the lens are not.
    """
    kind = kinds[0]
    unknowns = PlacedCamera(kind, np.zeros(3)).count
    refuse_few(method, p, unknowns // 2 + 1)
    refuse_collinear(method, p)
    refuse_one_plane(method, p)
    _refuse_parallel(method, q, p, kind)
    middle = p.mean(axis=0)
    ends = [
        adjusted(PlacedCamera(start, middle), q, p, UniformNoise(1.0))
        for start in resection_starts(q, p, kinds)
    ]
    best = min(ends, key=lambda end: float((end.residual**2).sum()))
    rms = float(np.sqrt((best.residual**2).sum(axis=1).mean()))
    if not rms <= MOST_OFF * kind.size[0]:
        raise InputError(
            f"{method}: no camera with the lens '{kind.lens}' explains the dots; the best is off by "
            f"{rms:.1f} px. Choose another lens, and check that columns and dots belong together."
        )
    found = adjusted(best.placed, q, p, UniformNoise(max(best.sigma_px, 1e-6)), NEAR)
    refuse_endless(method, found.camera)
    return found


def _refuse_parallel(method: str, q: Pixels, p: Vectors3, kind: Camera) -> None:
    """Raise where rays are parallel as far as the dots tell, and those of the lens are not.

    Without it a focal length would grow for hundreds of steps, with every lens model that is tried.

    Raises
    ------
    InputError
        They are.
    """
    if kind.model.parallel or kind.window is not None:
        return
    dist = undistorted_dist(LENSES[TELECENTRIC])
    start = parallel_start(q, p, Camera(kind.K, TELECENTRIC, dist, np.eye(4), kind.size))
    if start is None:
        return
    square = ((start.project(p).q - q) ** 2).sum(axis=1)
    if not np.sqrt(square.mean()) <= _MOST_OFF_PARALLEL * kind.size[0]:
        return
    camera = adjusted(PlacedCamera(start, p.mean(axis=0)), q, p, UniformNoise(1.0)).camera
    if Perspectivity.of(camera, [Sight(q, transform(camera.T_cam_world, p))]).is_none(camera):
        raise parallel_error(method)


def adjusted(
    start: PlacedCamera, q: Pixels, p: Vectors3, whitening: Whitening, damping: Damping = FAR
) -> ResectedCamera:
    """Return the camera nearest to pixels, from a start that images all points.

    Where the points leave the lens open up to folds inside the picture, its coefficients are held tighter.

    Parameters
    ----------
    start : PlacedCamera
    q, p : ndarray, shapes (n, 2) and (n, 3)
        Pixels, and world points in mm.
    whitening : Whitening
        The covariance is right if this is.
    damping : Damping
        :data:`FAR` or :data:`NEAR`.
    """
    wide = adjusted_with_prior(start, q, p, whitening, damping, PriorWidth.WIDE)
    if not wide.lens(whitening).is_open:
        return wide
    narrow = adjusted_with_prior(start, q, p, whitening, damping, PriorWidth.NARROW)
    ratio = narrow.sigma_px / max(wide.sigma_px, np.finfo(np.float64).tiny)
    return narrow if narrow_is_better([wide.camera], [narrow.camera], ratio) else wide


def adjusted_with_prior(
    start: PlacedCamera, q: Pixels, p: Vectors3, whitening: Whitening, damping: Damping, held: PriorWidth
) -> ResectedCamera:
    """Return the camera nearest to pixels, with one prior of the lens's coefficients.

    Parameters
    ----------
    start, q, p, whitening, damping
        As for `adjusted`.
    held : PriorWidth
    """
    problem = ResectionProblem(q, p, whitening, lens_prior(start, p, held))
    placed = minimize(problem, start, _STOPPING, damping).parameters
    residual = placed.camera.project(p).q - q
    freedom = max(1, residual.size - placed.count)
    return ResectedCamera(
        placed,
        problem.linearize(placed).covariance,
        residual,
        float(np.sqrt((residual**2).sum() / freedom)),
        held,
    )
