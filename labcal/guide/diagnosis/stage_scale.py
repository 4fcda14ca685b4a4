"""The scale of a target by the readings of a stage."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.calibrate.resection.resected import resect
from labcal.distributions import f_tail
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.guide.diagnosis.evidence import Evidence

_FEWEST = 4
"""Views with readings."""
_STEPS = (0.01, 0.002)
"""Steps of the scale in each round, for its derivative."""
_MOST = 0.3
"""Deviation of the scale from 1 beyond which no print is meant."""


@dataclass(frozen=True)
class StageDots:
    """Dots of one camera in views of which a stage tells the pose.

    Attributes
    ----------
    size : (int, int)
        Of the pictures, px.
    q : float64 array, (n, 2)
    local : float64 array, (n, 3)
        On the print as declared, mm.
    rotation, shift : float64 array, (n, 3, 3) and (n, 3)
        By which the stage takes them to the world, mm.
    view : int array, (n,)
    """

    size: tuple[int, int]
    q: Pixels
    local: Vectors3
    rotation: Float64[np.ndarray, "n 3 3"]
    shift: Vectors3
    view: np.ndarray

    def residuals(self, scale: float, lens: str) -> tuple[Float64[np.ndarray, "n 2"], float]:
        """Return the residuals of the camera that fits a scale of the print best, px, and its distance, mm.

        Raises
        ------
        InputError
            The dots determine no camera.
        """
        p = scale * np.einsum("nij,nj->ni", self.rotation, self.local) + self.shift
        found = resect("diagnose", self.q, p, camera_of_lens(lens, self.size, None))
        away = transform(found.camera.T_cam_world, p)
        return found.residual, float(np.sqrt((away**2).sum(axis=1).mean()))


@dataclass(frozen=True)
class StageScale:
    """Ratio of distances that a stage reads to those that the target's pitch gives.

    Attributes
    ----------
    ratio, sigma : float
    p_value : float
        That a pitch as declared gives such a ratio.
    harm_mm : float
        RMS error of points by it, where the target was.
    """

    ratio: float
    sigma: float
    p_value: float
    harm_mm: float

    @property
    def percent(self) -> float:
        """Relative excess of the pitch, %."""
        return 100.0 * (self.ratio - 1.0)

    @property
    def sigma_percent(self) -> float:
        """Standard deviation of it, %."""
        return 100.0 * self.sigma

    @classmethod
    def of(cls, evidence: Evidence, left_out: tuple[str, ...] = ()) -> "StageScale | None":
        """Return the scale of the print by which the stage's places fit best; None where nothing tells it.

        Parameters
        ----------
        evidence : Evidence
        left_out : tuple of str
            Views in which the target does not lie as the stage says.

        Notes
        -----
        Cameras are resected from the places of the dots by the readings, the print scaled; Gauss-Newton in
        the scale alone. Its variance is that of clusters, the views (Liang and Zeger 1986, "Longitudinal data
        analysis using generalized linear models"): dots of a view share the errors of its reading.
        """
        if len(evidence.nominal_poses) < _FEWEST:
            return None
        scale = 1.0
        try:
            cameras = [_dots(evidence, name, left_out) for name in evidence.detections.cameras]
            cameras = [one for one in cameras if len(set(one.view.tolist())) >= _FEWEST]
            if not cameras:
                return None
            for step in _STEPS:
                slope, rest, away = _linearised(cameras, scale, step, evidence.lens)
                square = float((slope**2).sum())
                scale -= float((slope * rest).sum()) / square
                if not abs(scale - 1.0) < _MOST:
                    return None
            slope, rest, away = _linearised(cameras, scale, _STEPS[-1], evidence.lens)
        except InputError:
            return None
        view = np.concatenate([one.view for one in cameras])
        of_view = np.bincount(view, weights=(slope * rest).sum(axis=1))
        count = len(set(view.tolist()))
        square = float((slope**2).sum())
        sigma = float(np.sqrt((of_view**2).sum() * count / (count - 1.0))) / square
        p_value = f_tail(((scale - 1.0) / max(sigma, 1e-12)) ** 2, 1, float(count - 2))
        return cls(scale, sigma, p_value, abs(scale - 1.0) * away)


def _dots(evidence: Evidence, camera: str, left_out: tuple[str, ...]) -> StageDots:
    dots, nominal = evidence.detections, evidence.nominal_poses
    known = [view for view in nominal if view not in left_out]
    own = dots.where(dots.ok & dots.has_id & (dots.camera == camera) & np.isin(dots.view, known))
    poses = np.array([nominal[view] for view in own.view.tolist()]).reshape(-1, 4, 4)
    number = {view: at for at, view in enumerate(known)}
    return StageDots(
        evidence.detections.picture_size(camera),
        own.position,
        evidence.target.points(own.index),
        poses[:, :3, :3],
        poses[:, :3, 3],
        np.array([number[view] for view in own.view.tolist()], dtype=np.int64),
    )


def _linearised(
    cameras: list[StageDots], scale: float, step: float, lens: str
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return the derivative of residuals by the scale, the residuals at it, and the cameras' distance, mm."""
    slopes, rests, away = [], [], 0.0
    for one in cameras:
        more, _ = one.residuals(scale + step, lens)
        less, _ = one.residuals(scale - step, lens)
        rest, away = one.residuals(scale, lens)
        slopes.append((more - less) / (2.0 * step))
        rests.append(rest)
    return np.concatenate(slopes), np.concatenate(rests), away
