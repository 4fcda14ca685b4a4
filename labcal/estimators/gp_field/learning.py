"""Joint estimation of a camera and a residual field."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Pixels, Vectors3
from labcal.calibrate.resection.resected import NEAR, ResectedCamera, adjusted
from labcal.estimators.gp_field.evidence import FieldScale, field_scale
from labcal.estimators.gp_field.fitted_camera import Asked, FittedCamera, FittedField
from labcal.estimators.gp_field.pixel_field import PixelField
from labcal.estimators.gp_field.places import Places
from labcal.estimators.gp_field.stage_moves import StageMoves, likeliest_moves
from labcal.optim.whitening import CorrelatedNoise
from labcal.run.threads import one_blas_thread

ROUNDS = 3
"""After these, neither the field's scale nor the camera moves by more than a few percent of their sd, unless
the field is so strong that it can stand for much of the camera."""
_SETTLED = 0.1
"""Change of a field in a round, as a share of it, up to which it has come to rest."""

_EXACT_PX = 1e-4
"""Residuals below this are those of a simulation without noise; a field would follow rounding errors."""


@one_blas_thread()
def fitted_camera(
    start: ResectedCamera, q: Pixels, p: Vectors3, moves: StageMoves | None = None
) -> FittedCamera:
    """Return a camera with the field that its residuals require, or without if they require none.

    Parameters
    ----------
    start : ResectedCamera
        Found with independent errors.
    q, p : ndarray, shapes (n, 2) and (n, 3)
        Pixels, and the world points (mm) that they see.
    moves : StageMoves, optional
        Errors of the stage that the points come from, which the field should not explain.

    Notes
    -----
    In rounds: the field's scale by restricted likelihood, then the camera once more by generalised least
    squares with the field as correlated noise, since otherwise its pose absorbs the field. Where the rounds
    do not come to rest, camera and field drift off together, and the likeliest round is taken. Some
    displacements are a smoother function of where light arrives than of where it would have arrived: both are
    tried, and the likelier one is taken. So are waves and none, where the first round does not decide.
    """
    if start.sigma_px < _EXACT_PX:
        return FittedCamera(start.placed, start.covariance, start.sigma_px)
    seen = _Seen(q, p, moves)
    ideal = _fitted(_Stage(start, None, start.camera.project(p).q), seen, Asked.IDEAL)
    if ideal is None:
        return FittedCamera(start.placed, start.covariance, start.sigma_px)
    known = [ideal]
    for begun in (ideal, *ideal.with_waves()):
        # At the places of the lens formula alone waves have harmonics: those not found are looked for anew.
        scale = begun.scale if begun.scale.kernel.waves is not None else None
        arrived = _fitted(_Stage(begun.found, scale, begun.arrived), seen, Asked.ARRIVED)
        known += [] if arrived is None else [arrived]
    return max(known, key=lambda one: one.likelihood).camera


@dataclass(frozen=True)
class _Seen:
    """Pixels, the world points (mm) that they see, and how a stage moves these."""

    q: Pixels
    p: Vectors3
    moves: StageMoves | None


@dataclass(frozen=True)
class _Stage:
    """The initial values of rounds: a camera, perhaps the scale of the field, and its positions."""

    found: ResectedCamera
    scale: FieldScale | None
    at: Pixels


@dataclass(frozen=True)
class _Learned:
    """The result of some rounds."""

    found: ResectedCamera
    q: Pixels
    """Measured, without what errors of the stage explain."""
    scale: FieldScale
    restricted: float
    """The restricted log-likelihood of the scale."""
    fitted: FittedField
    waves: FieldScale | None
    """Of waves that are as likely, of the first round."""

    @property
    def camera(self) -> FittedCamera:
        """The camera with its field."""
        return FittedCamera(self.found.placed, self.found.covariance, self.scale.noise_px, self.fitted)

    @property
    def likelihood(self) -> float:
        """The logarithm of the likelihood ratio of the pixels with and without the field.

        A field that is asked where light arrives gives the density of measured minus explained pixels; that
        of the pixels takes the determinant of how the former change with the latter.
        """
        if self.fitted.asked is Asked.IDEAL:
            return self.scale.gain
        field = self.fitted.field
        turn = np.eye(2) - field.slopes(field.x)[:, :, :2] / self.fitted.places.width_px
        with np.errstate(divide="ignore"):
            return self.scale.gain + float(np.log(np.maximum(np.linalg.det(turn), 0.0)).sum())

    def with_waves(self) -> tuple["_Learned", ...]:
        """Return the same camera with the field of waves that is as likely, if there is one."""
        if self.waves is None:
            return ()
        field = PixelField(self.waves, self.fitted.field.x, self.fitted.field.residual)
        return (replace(self, scale=self.waves, fitted=replace(self.fitted, field=field), waves=None),)

    @property
    def arrived(self) -> Pixels:
        """The true images of training points, by lens and field."""
        return np.asarray(self.q + self.found.residual + self.fitted.field.smoothed())


def _fitted(stage: _Stage, seen: _Seen, asked: Asked) -> _Learned | None:
    """Return camera and field after some rounds, or None if no field is required."""
    ends = list(_rounds(stage, seen, asked))
    if len(ends) < ROUNDS:
        return None
    before, last = (end.fitted.field.smoothed() for end in ends[-2:])
    if np.linalg.norm(last - before) <= _SETTLED * np.linalg.norm(last):
        return ends[-1]
    return max(ends, key=lambda end: end.restricted)


def _rounds(stage: _Stage, seen: _Seen, asked: Asked) -> Iterator[_Learned]:
    """Yield camera and field after each round, until no field is required."""
    found, scale, at, waves = stage.found, stage.scale, stage.at, None
    p, moves, by_stage = seen.p, seen.moves, None
    for _ in range(ROUNDS):
        camera = found.camera
        x = Places.of(camera, p).inputs(camera, at, p)
        by_camera = found.placed.seen(p).by_camera
        residual = -found.residual
        if moves is not None:  # that of the camera is without them
            residual, by_stage = seen.q - camera.project(p).q, moves.pixels(camera, p)
        likely = field_scale(x, residual, by_camera, scale, by_stage)
        scale, waves = likely.scale, waves or likely.waves
        if scale.amplitude_px == 0.0:
            return
        root, q = scale.root(x), seen.q
        if by_stage is not None:
            q = q - likeliest_moves(root, residual, by_camera, by_stage)
        found = adjusted(found.placed, q, p, CorrelatedNoise(root), NEAR)
        if not np.isfinite(found.residual).all():
            return
        if asked is Asked.IDEAL:
            at = found.camera.project(p).q
        camera = found.camera
        places = Places.of(camera, p)
        field = PixelField(scale, places.inputs(camera, at, p), -found.residual)
        fitted = FittedField(field, places, asked, np.array(p))
        end = _Learned(found, q, scale, likely.likelihood, fitted, waves)
        if asked is Asked.ARRIVED:
            at = end.arrived
        yield end
