"""One drawn set of a board in the hand: measured, calibrated, and compared with the truth."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ConfigDict
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose
from labcal.bench.boards.imaged_print import DrawnPrint
from labcal.bench.solve.budget_rigs import PairKind
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
from labcal.geometry.poses import pose, transform
from labcal.reconstruct.reconstruction import reconstruct_centres
from labcal.render.sensor_response import Shot
from labcal.report.values import Measured
from labcal.rng import generator
from labcal.scene.photometry import Photometry
from labcal.scene.printed import key_indices
from labcal.targets.catalogue import load_target
from labcal.targets.target import PrintableTarget

BOARDS: Mapping[str, str] = {
    "chessboard": "chessboard-9x6",
    "marked chessboard": "chessboard-marked-13x8",
    "charuco": "charuco-12x9",
    "aprilgrid": "aprilgrid-6x6",
    "dots": "webcam-a4",
}
"""A shipped target of each kind; the last one for comparison."""
VIEWS, HELD_OUT = 12, 4
PAIR = PairKind(
    (640, 480), 560.0, 150.0, 520.0, 90.0, 240.0, 0.0,
    ((-0.2, 0.06, 6e-4, -4e-4, 0.0), (-0.21, 0.07, -5e-4, 7e-4, 0.0)),
)  # fmt: skip
PHOTOMETRY = Photometry(format="png")
_TILT = 0.4
"""Standard deviation of the board's rotation about each axis, rad."""
_NEAR, _FAR = 0.8, 1.25
"""Of the pair's distance."""
_IN_SIGHT = 0.7
"""Share of the places of a board that both cameras see at least."""
_FRAME_PX = 8.0
"""Distance from the frame of a place that is in sight."""
_MOST_SIGMAS = 3.0
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


class BoardFigures(BaseModel):
    """Figures of one set.

    Attributes
    ----------
    pictures, indexed : int
    wrong : int
        Measured places that are not where the place of their id is.
    places : int
        Measured ones.
    error_px, stated_px : float
        RMS 2-D error of the places, and what is stated of them.
    normalised : float
        Squared errors of places in units of their covariance, a coordinate.
    residual : float
        RMS residual of the calibration over what the covariances of the places leave to expect.
    parameters : int
        Of both cameras.
    mean_square : float
        Their squared errors in units of their covariance, a parameter.
    worst : float
        Largest error of a single parameter in units of its standard deviation.
    beyond : int
        Parameters that are off by more than three of them.
    coverage : float
        Share of points of views that were held out within their 95% ellipsoids.
    error_mm, stated_mm : float
        RMS 3-D error of these points, and what is stated.
    warned : bool
        `calibrate` warns that views disagree, or that the lens lacks coefficients.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    pictures: int
    indexed: int
    wrong: int
    places: int
    error_px: Measured
    stated_px: Measured
    normalised: Measured
    residual: Measured
    parameters: int
    mean_square: Measured
    worst: Measured
    beyond: int
    coverage: Measured
    error_mm: Measured
    stated_mm: Measured
    warned: bool


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
        beyond=int((errors.sigmas > _MOST_SIGMAS).sum()),
        coverage=coverage(off[usable], points.covariance[usable]),
        error_mm=_rms(off[usable]),
        stated_mm=_stated(points.covariance[usable]),
        warned=found.sources.views.is_beyond_chance
        or found.disagreement is not None
        or any(fit.misfit is not None or fit.two_lenses is not None for fit in found.fits.values()),
    )


def board_poses(target: PrintableTarget, views: int, random: np.random.Generator) -> list[Pose]:
    """Return ``T_world_target`` of views in which both cameras see enough of a board to number it.

    Parameters
    ----------
    target : PrintableTarget
        Boards of every size are held as far away as they look equally wide.
    views : int
    random : Generator
    """
    p = target.points()
    x_min, y_min, x_max, y_max = target.extent_mm
    scale = max(x_max - x_min, y_max - y_min) / PAIR.board_mm
    cameras = PAIR.cameras()
    key = np.array([row * target.cols + col for col, row in key_indices(target)], dtype=np.int64)
    low, high = np.full(2, _FRAME_PX), np.array(PAIR.size) - 1.0 - _FRAME_PX
    found = list[Pose]()
    while len(found) < views:
        tilt = Rotation.from_rotvec(_TILT * random.standard_normal(3)).as_matrix()
        R = np.diag([1.0, -1.0, -1.0]) @ tilt
        sideways = PAIR.reach_mm * random.uniform(-1.0, 1.0, 2)
        middle = scale * np.array([*sideways, PAIR.distance_mm * random.uniform(_NEAR, _FAR)])
        T = pose(R, middle - R @ p.mean(axis=0))
        q = np.stack([camera.project(transform(T, p)).q for camera in cameras])
        seen = np.asarray(((q > low) & (q < high)).all(axis=(0, 2)))
        if seen.mean() >= _IN_SIGHT and seen[key].all():
            found.append(T)
    return found


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
        """Return errors and stated covariances of all measured places, px and px squared.

        The centroid of a dot is none of the image of its centre, so that errors of dots hold that, too.
        """
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
