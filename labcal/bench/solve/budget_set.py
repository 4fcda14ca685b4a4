"""One simulated set: calibrated anew, and what its stated budget holds of the true errors."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ConfigDict
from scipy.spatial.transform import Rotation

from labcal.arrays import Vectors3
from labcal.bench.solve.budget_rigs import KINDS, PairKind
from labcal.bench.solve.camera_errors import camera_errors
from labcal.bench.solve.pair_dots import CAMERAS, pair_dots
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.named_pixels import NamedPixels
from labcal.distributions import chi2_quantile
from labcal.errors import InputError
from labcal.evaluate.statistics import coverage
from labcal.geometry.poses import pose, rotation_vector
from labcal.reconstruct.distance import distance
from labcal.reconstruct.named_points import reconstruct_named
from labcal.reconstruct.named_reconstruction import NamedReconstruction
from labcal.reconstruct.plane import plane
from labcal.reconstruct.point_budget import Budget
from labcal.reconstruct.rigid_motion import rigid_motion
from labcal.report.values import Measured
from labcal.rng import generator

NOISE_PX = 0.05
PRINTS = ("even", "uneven", "uneven, freed")
"""Even; off by its kind's standard deviation; the same with the dots freed."""
POINTS, BODIES = 200, 25
"""Of each set: points, of which bodies of :data:`_OF_BODY` are made."""
_OF_BODY = 8
_MOVED_MM, _TURNED_RAD = 2.0, 0.01
CONFIDENCE = 0.95


@dataclass(frozen=True)
class BudgetSet:
    """A case: kind of pair, print, number of views, lens model of the calibration."""

    kind: str
    surface: str
    views: int
    lens: str
    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        surface = self.surface.replace(", ", "-")
        return f"{self.kind}-{surface}-{self.views}-{self.lens}-{self.seed}"


class BudgetFigures(BaseModel):
    """Shares of a set's true errors that are inside the stated 95% regions."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    points: Measured
    """Of points, in the datum of the rig."""
    noise_alone: Measured
    """Of points by the noise of pixels alone."""
    distances: Measured
    planes: Measured
    motions: Measured
    parameters: Measured
    """Squared errors of the cameras in units of their covariance, per parameter; NaN for another lens."""
    warned: bool
    """`calibrate` warns that views disagree, or that the lens lacks coefficients."""


def measured_set(case: BudgetSet) -> BudgetFigures:
    """Simulate, calibrate, reconstruct other points, and compare with the truth."""
    kind = KINDS[case.kind]
    random = generator(case.seed, "bench solve", "budget", case.kind, case.surface, str(case.views))
    places = DotTreatment.FREED if case.surface == PRINTS[2] else DotTreatment.DECLARED
    settings = HandheldSettings(eccentricity_rounds=0, dot_places=places)
    found = calibrate_handheld(simulated_dots(kind, case, random), kind.target(), case.lens, settings)
    rig = found.rig
    if rig.covariance is None:
        raise InputError("A calibration with free lenses states no covariance.")
    true = kind.points(POINTS, random)
    members = random.permutation(POINTS)[: BODIES * _OF_BODY].reshape(BODIES, _OF_BODY)
    everything = np.concatenate([true, _moved(true, members, random), _flattened(true, members)])
    pixels = _named(kind, everything, random)
    reconstruction = reconstruct_named(rig, pixels)
    alone = reconstruct_named(rig, pixels, Budget.NOISE)
    # A pixel that noise or motion took out of its picture is not used: its point, and its body, do not count.
    placed = np.isfinite(reconstruction.points.point).all(axis=1)
    one = placed[:POINTS]
    error = (reconstruction.points.point - everything)[:POINTS][one]
    cameras = [rig.camera(name) for name in rig.cameras]
    return BudgetFigures(
        points=coverage(error, reconstruction.points.covariance[:POINTS][one]),
        noise_alone=coverage(error, alone.points.covariance[:POINTS][one]),
        distances=_distances(reconstruction, true, one),
        planes=_planes(reconstruction, everything, members[placed[members + 2 * POINTS].all(axis=1)]),
        motions=_motions(
            reconstruction, everything, members[(placed[members] & placed[members + POINTS]).all(axis=1)]
        ),
        parameters=_per_parameter(cameras, kind.cameras(), rig.covariance.matrix),
        warned=found.sources.views.is_beyond_chance
        or any(fit.misfit is not None for fit in found.fits.values()),
    )


def calibrated(kind: PairKind, random: np.random.Generator) -> Rig:
    """Return the rig of a set with an even print and 12 views, with the covariance that it states."""
    case = BudgetSet("", PRINTS[0], 12, "brown5", 0)
    settings = HandheldSettings(eccentricity_rounds=0)
    return calibrate_handheld(simulated_dots(kind, case, random), kind.target(), case.lens, settings).rig


def _named(kind: PairKind, places: Vectors3, random: np.random.Generator) -> NamedPixels:
    """Return the pixels of places, with noise, as another program would give them: by names."""
    clean = np.stack([camera.project(places).q for camera in kind.cameras()], axis=1)
    q = (clean + NOISE_PX * random.standard_normal(clean.shape)).swapaxes(0, 1).reshape(-1, 2)
    names = [f"p{number}" for number in range(len(places))]
    known = np.tile(NOISE_PX**2 * np.eye(2), (len(q), 1, 1))
    return NamedPixels(["all"] * len(q), np.repeat(CAMERAS, len(places)), names * len(CAMERAS), q, known)


def simulated_dots(kind: PairKind, case: BudgetSet, random: np.random.Generator) -> Detections:
    """Return images of centres with noise, of a print that is as the case says."""
    target = kind.target()
    dots = target.points()
    if case.surface != PRINTS[0]:
        dots[:, :2] += kind.print_mm * random.standard_normal((len(dots), 2))
    views = kind.poses(case.views, random)
    return pair_dots(kind.cameras(), target, dots, views, (NOISE_PX, random))


def _moved(true: Vectors3, members: np.ndarray, random: np.random.Generator) -> Vectors3:
    """Return all points after a rigid motion of their body."""
    moved = true.copy()
    for body in members:
        turn = Rotation.from_rotvec(_TURNED_RAD * random.standard_normal(3)).as_matrix()
        middle = true[body].mean(axis=0)
        moved[body] = (true[body] - middle) @ turn.T + middle + _MOVED_MM * random.standard_normal(3)
    return moved


def _flattened(true: Vectors3, members: np.ndarray) -> Vectors3:
    """Return all points on the plane that lies nearest to those of their body."""
    flat = true.copy()
    for body in members:
        arm = true[body] - true[body].mean(axis=0)
        normal = np.linalg.svd(arm)[2][2]
        flat[body] = true[body] - np.outer(arm @ normal, normal)
    return flat


def _distances(found: NamedReconstruction, true: Vectors3, placed: np.ndarray) -> float:
    """Return the share of distances of neighbours in the list within 95% of their truth."""
    inside = []
    for one in range(0, len(true), 2):
        if not placed[one : one + 2].all():
            continue
        length = distance(found, one, one + 1)
        off = length.value - float(np.linalg.norm(true[one] - true[one + 1]))
        inside.append(off**2 <= chi2_quantile(CONFIDENCE, 1) * length.sigma**2)
    return float(np.mean(inside))


def _planes(found: NamedReconstruction, everything: Vectors3, members: np.ndarray) -> float:
    """Return the share of planes through flat bodies within the 95% regions of height and slopes."""
    inside = []
    for body in members + 2 * POINTS:
        fitted = plane(found, body)
        # The true plane in the axes of the fitted one: its height above the centre, and its slopes.
        arm = (everything[body] - fitted.centre) @ fitted.axes.T
        design = np.stack([np.ones(len(arm)), arm[:, 0], arm[:, 1]], axis=1)
        off = np.linalg.lstsq(design, arm[:, 2], rcond=None)[0]
        inside.append(_within(off, fitted.shares.total))
    return float(np.mean(inside))


def _motions(found: NamedReconstruction, everything: Vectors3, members: np.ndarray) -> float:
    """Return the share of rigid motions of bodies within 95% of their truth."""
    inside = []
    for body in members:
        moved = rigid_motion(found, body, body + POINTS)
        exact = everything[body + POINTS].mean(axis=0) - everything[body].mean(axis=0)
        turn = _turn(everything[body], everything[body + POINTS])
        off_turn = rotation_vector(pose(moved.T_after_before[:3, :3] @ turn.T, np.zeros(3)))
        inside.append(_within(np.concatenate([moved.displacement_mm - exact, off_turn]), moved.shares.total))
    return float(np.mean(inside))


def _turn(before: Vectors3, after: Vectors3) -> Float64[np.ndarray, "3 3"]:
    """Return the rotation between exact places of a rigid body."""
    found, _ = Rotation.align_vectors(after - after.mean(axis=0), before - before.mean(axis=0))
    return np.asarray(found.as_matrix())


def _within(off: np.ndarray, covariance: np.ndarray) -> bool:
    """Tell whether errors are inside the 95% ellipsoid of their covariance."""
    return bool(off @ np.linalg.solve(covariance, off) <= chi2_quantile(CONFIDENCE, len(off)))


def _per_parameter(
    found: list[Camera], true: tuple[Camera, ...], covariance: Float64[np.ndarray, "n n"]
) -> float:
    """Return the mean square of the cameras' errors in units of their covariance."""
    if any(one.lens != other.lens for one, other in zip(found, true, strict=True)):
        return float("nan")
    return camera_errors(found, true, covariance).mean_square
