"""One drawn set of a board in the hand: measured, calibrated, and compared with the truth."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pose
from labcal.bench.boards.imaged_print import DrawnPrint
from labcal.bench.solve.board_figures import BoardFigures
from labcal.bench.solve.board_poses import BOARDS, PAIR, board_poses
from labcal.bench.solve.camera_errors import camera_errors
from labcal.bench.solve.pair_dots import CAMERAS
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.correspond.detections import Detections
from labcal.correspond.gathering import gather
from labcal.correspond.points import PointFlag
from labcal.correspond.sources import Source
from labcal.detect.detector import detect_dots
from labcal.errors import InputError
from labcal.evaluate.statistics import coverage
from labcal.geometry.poses import transform
from labcal.reconstruct.reconstruction import reconstruct_centres
from labcal.render.sensor_response import Shot
from labcal.rng import generator
from labcal.scene.photometry import Photometry
from labcal.targets.catalogue import load_target
from labcal.targets.target import PrintableTarget

VIEWS, HELD_OUT = 12, 4
PHOTOMETRY = Photometry(format="png")
_WRONG = 0.25
"""Distance from its true place at which a measured place has a wrong id, in steps between places."""


@dataclass(frozen=True)
class BoardSet:
    """A case: kind of board."""

    board: str
    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.board.replace(' ', '-')}-{self.seed}"


def measured_board_set(case: BoardSet) -> BoardFigures:
    """Draw, measure and calibrate, then reconstruct views that were held out, and compare with the truth."""
    random = generator(case.seed, "bench solve", "boards", case.board)
    target = load_target(BOARDS[case.board])
    views = board_poses(target, VIEWS + HELD_OUT, random)
    drawn = DrawnViews.of(target, views, random)
    dots, held = drawn.detections, np.isin(drawn.detections.view, list(drawn.names)[VIEWS:])
    found = calibrate_handheld(dots.where(~held), target, "brown5", HandheldSettings())
    if found.rig.covariance is None:
        raise InputError("A calibration with free lenses states no covariance.")
    error, covariance = drawn.errors()
    errors = camera_errors(
        [found.rig.camera(name) for name in CAMERAS], PAIR.cameras(), found.rig.covariance.matrix
    )
    points = reconstruct_centres(found.rig, dots.where(held), target).points
    number = points.index[:, 1] * target.cols + points.index[:, 0]
    view = np.array([drawn.names[name] for name in points.view.tolist()])
    off = points.point - drawn.in_world[view, number]
    usable = points.flag == PointFlag.OK
    return BoardFigures(
        pictures=len(CAMERAS) * len(views),
        indexed=drawn.indexed,
        wrong=drawn.wrong,
        places=len(error),
        error_px=_rms(error),
        stated_px=_stated(covariance),
        normalised=float(np.einsum("ni,nij,nj->n", error, np.linalg.inv(covariance), error).mean() / 2.0),
        residual=_residual(found, dots.where(~held)),
        parameters=len(errors.error),
        mean_square=errors.mean_square,
        worst=float(errors.sigmas.max()),
        coverage=coverage(off[usable], points.covariance[usable]),
        error_mm=_rms(off[usable]),
        stated_mm=_stated(points.covariance[usable]),
        warned=found.sources.views.is_beyond_chance
        or found.disagreement is not None
        or any(fit.misfit is not None or fit.two_lenses is not None for fit in found.fits.values()),
    )


@dataclass(frozen=True)
class DrawnViews:
    """Views of a board as the detector measures them, with the truth.

    Attributes
    ----------
    target : PrintableTarget
    names : dict of str to int
        Numbers of the views by name.
    detections : Detections
    true_px : ndarray, shape (views, cameras, places, 2)
    in_world : ndarray, shape (views, places, 3)
        mm.
    indexed : int
        Pictures with ids.
    """

    target: PrintableTarget
    names: dict[str, int]
    detections: Detections
    true_px: Float64[np.ndarray, "views cameras places 2"]
    in_world: Float64[np.ndarray, "views places 3"]
    indexed: int

    @classmethod
    def of(cls, target: PrintableTarget, views: list[Pose], random: np.random.Generator) -> "DrawnViews":
        """Draw and measure the pictures of both cameras in all views."""
        board, seed = DrawnPrint.of(target), int(random.integers(2**31))
        cameras = PAIR.cameras()
        names = {f"view-{number:02d}": number for number in range(len(views))}
        sources, found, true = [], [], []
        for name, T in zip(names, views, strict=True):
            for own, camera in zip(CAMERAS, cameras, strict=True):
                seen = board.seen(camera, T, PHOTOMETRY, Shot(seed, name, own))
                dots = detect_dots(seen.picture, target)
                found.append(
                    replace(
                        dots,
                        size=camera.size,
                        position=dots.position + seen.corner,
                        seen_at=dots.seen_at + seen.corner,
                    )
                )
                sources.append(Source(name, own, f"{name}_{own}.png", camera.size))
                true.append(seen.places)
        return cls(
            target=target,
            names=names,
            detections=gather(sources, found),
            true_px=np.reshape(true, (len(views), len(CAMERAS), target.count, 2)),
            in_world=np.stack([transform(T, target.points()) for T in views]),
            indexed=sum(dots.indexed for dots in found),
        )

    @property
    def wrong(self) -> int:
        """Measured places that are not where the place of their id is."""
        number, far = self._numbers(), 0
        used = self._used()
        for view, camera in np.unique(number[:, :2], axis=0).tolist():
            here = (number[:, 0] == view) & (number[:, 1] == camera)
            true = self.true_px[view, camera]
            q, own = used.position[here], number[here, 2]
            others = np.linalg.norm(true[own][:, None] - true[None], axis=-1)
            step = np.where(others > 0.0, others, np.inf).min(axis=1)
            far += int((np.linalg.norm(q - true[own], axis=1) > _WRONG * step).sum())
        return far

    def errors(self) -> tuple[Float64[np.ndarray, "n 2"], Float64[np.ndarray, "n 2 2"]]:
        """Return errors and stated covariances of all measured places, px and px squared."""
        used, (view, camera, place) = self._used(), self._numbers().T
        return used.position - self.true_px[view, camera, place], used.covariance

    def _used(self) -> Detections:
        return self.detections.where(self.detections.has_id & (self.detections.flag == "ok"))

    def _numbers(self) -> np.ndarray:
        """Return number of view, camera and place of each measured place, shape (n, 3)."""
        used = self._used()
        place = used.index[:, 1] * self.target.cols + used.index[:, 0]
        view = [self.names[name] for name in used.view.tolist()]
        camera = [CAMERAS.index(name) for name in used.camera.tolist()]
        return np.stack([np.array(view), np.array(camera), place], axis=-1)


def _residual(found: HandheldCalibration, dots: Detections) -> float:
    """Return the RMS residual over that which covariances leave, by degrees of freedom."""
    used = dots.where(dots.has_id & (dots.flag == "ok") & np.isin(dots.view, found.views))
    entered = int((~found.residuals.outlier).sum())
    parameters = len(found.rig.covariance.matrix if found.rig.covariance else ()) + 6 * len(found.views)
    free = 1.0 - parameters / (2.0 * entered)
    return float(found.rms_px / (_stated(used.covariance) * np.sqrt(free)))


def _rms(error: np.ndarray) -> float:
    return float(np.sqrt((error**2).sum(axis=-1).mean()))


def _stated(covariance: np.ndarray) -> float:
    return float(np.sqrt(np.trace(covariance, axis1=-2, axis2=-1).mean()))
