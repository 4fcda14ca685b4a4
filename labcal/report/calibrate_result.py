"""Result of ``labcal calibrate``: the JSON document, and the same for people."""

from dataclasses import dataclass

from rich.console import Group
from rich.table import Table
from rich.text import Text

from labcal.calibrate.calibration import Calibration
from labcal.calibrate.dot_treatment import DotDecision
from labcal.calibrate.eccentricity import CorrectedEccentricity
from labcal.calibrate.epipolar_residual import epipolar_rms
from labcal.calibrate.freed_dots import FreedDots
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_choice import LensChoice
from labcal.calibrate.one_lens import TwoLenses
from labcal.calibrate.outlying_dots import OutlyingDots
from labcal.correspond.detections import Detections
from labcal.evaluate.print_shape import PrintShape, agreement, print_shape
from labcal.report.columns import name_column
from labcal.report.inconsistent_result import InconsistentResult, inconsistent_result
from labcal.report.lens_table import lens_table
from labcal.report.print_words import print_words
from labcal.targets.catalogue import AnyTarget

MOST_OUTLIERS = 200
"""Outliers that the document lists, the worst ones."""
_SHOWN_OUTLIERS = 10
"""Those that people are shown."""


@dataclass(frozen=True)
class SigmaResult:
    """Standard deviations of a camera's numbers in the rig; null where the views leave one open."""

    fx: float
    fy: float
    cx: float
    cy: float
    dist: list[float]
    rotation_rad: list[float]
    translation_mm: list[float]


@dataclass(frozen=True)
class CameraResult:
    """One camera in the JSON document of ``labcal calibrate``."""

    rms_px: float
    """Of this camera calibrated alone."""
    rms_in_rig_px: float
    K: list[list[float]]
    lens: str
    dist: list[float]
    views: int
    dots: int
    sigma: SigmaResult
    scatter_px: float
    """Of this camera alone: what dots scatter along each axis beyond their covariances."""
    undetermined: list[str]
    """Lens coefficients that the views leave open."""
    open_lens: bool
    """True if the dots do not determine the lens towards the picture's border, where a prior decides."""
    share_without_rays: float
    """Of the picture, where the lens folds."""
    two_lenses: TwoLenses | None
    """Groups of views that were taken through different lenses, so that the numbers are of neither; null
    where one lens explains all."""


@dataclass(frozen=True)
class OutlierResult:
    """A dot that did not enter, since it is farther off than noise explains."""

    view: str
    camera: str
    col: int
    row: int
    off_px: list[float]
    """Measured minus predicted."""


@dataclass(frozen=True)
class FreeDotsResult:
    """The print in the JSON document of ``labcal calibrate --free-dots``."""

    shape: PrintShape
    """As all cameras together find it."""
    agreement: list[float] | None
    """Correlation along x and y of what the first two cameras find, each alone; null for one camera."""


@dataclass(frozen=True)
class CalibrateResult:
    """The JSON document of ``labcal calibrate``."""

    cameras: dict[str, CameraResult]
    rms_px: float
    epipolar_rms_px: float
    skipped: list[str]
    outlier_count: int
    outliers: list[OutlierResult]
    """The worst ones, at most as many as :data:`MOST_OUTLIERS`."""
    centre_bias_px: CorrectedEccentricity
    stop_reason: str
    dot_places: DotDecision
    """The treatment of the dots on the print, and the reason."""
    free_dots: FreeDotsResult | None
    """The print, where its dots were freed."""
    lens_choice: LensChoice | None
    """Of ``--lens auto``."""
    held_out: list[str]
    """Views that did not enter, since they are to be scored."""
    calibrated_on: list[str]
    """Views that the cameras come from."""
    triangulation_rms_px: float | None
    """RMS triangulation residual; null for one camera."""
    inconsistent: InconsistentResult | None
    """Causes of contradictions between the cameras' poses of the target; null if there are none."""
    warnings: list[str]
    """Doubts about the result, and what was not tested."""

    @property
    def doubtful(self) -> bool:
        """True if pictures were left out, a camera had two lenses, or cameras contradict each other."""
        two_lenses = any(camera.two_lenses is not None for camera in self.cameras.values())
        return bool(self.skipped) or two_lenses or self.inconsistent is not None


def calibrate_result(made: Calibration, detections: Detections, target: AnyTarget) -> CalibrateResult:
    """Return the JSON document of a calibration from dots of a target."""
    found = made.found
    known = target if found.disagreement is None else None  # else points may be nowhere near a target
    epipolar_rms_px = epipolar_rms(found.rig, found.entering(detections), known)
    return CalibrateResult(
        cameras={name: _camera(found, name) for name in found.rig.cameras},
        rms_px=found.rms_px,
        epipolar_rms_px=epipolar_rms_px,
        skipped=list(found.skipped),
        outlier_count=len(found.outliers),
        outliers=_outliers(found.outliers),
        centre_bias_px=found.eccentricity,
        stop_reason=found.reason.value,
        dot_places=found.dots,
        free_dots=None if found.freed is None else _free_dots(found.freed, found),
        lens_choice=made.choice,
        held_out=list(made.held_out),
        calibrated_on=list(made.calibrated_on),
        triangulation_rms_px=None
        if found.rig.calibration is None
        else found.rig.calibration.triangulation_rms_px,
        inconsistent=inconsistent_result(found),
        warnings=list(made.warnings),
    )


def _camera(found: HandheldCalibration, name: str) -> CameraResult:
    record, fit = found.rig.cameras[name], found.fits[name]
    fx, fy, cx, cy = fit.sigma.intrinsics.tolist()
    return CameraResult(
        rms_px=fit.rms_px,
        rms_in_rig_px=fit.rms_in_rig_px,
        K=[list(row) for row in record.K],
        lens=record.lens,
        dist=list(record.dist),
        views=len(fit.views),
        dots=fit.dots,
        sigma=SigmaResult(
            fx, fy, cx, cy,
            dist=fit.sigma.dist.tolist(),
            rotation_rad=fit.sigma.rotation_rad.tolist(),
            translation_mm=fit.sigma.translation_mm.tolist(),
        ),
        scatter_px=fit.scatter_px,
        undetermined=list(fit.undetermined),
        open_lens=fit.open_lens,
        share_without_rays=found.rig.camera(name).share_without_rays,
        two_lenses=fit.two_lenses,
    )  # fmt: skip


def _outliers(outliers: OutlyingDots) -> list[OutlierResult]:
    columns = (outliers.view, outliers.camera, outliers.index, outliers.off_px)
    lines = zip(*(column[:MOST_OUTLIERS].tolist() for column in columns), strict=True)
    return [OutlierResult(view, camera, col, row, off) for view, camera, (col, row), off in lines]


def _free_dots(freed: FreedDots, found: HandheldCalibration) -> FreeDotsResult:

    alone = [fit.freed for fit in found.fits.values() if fit.freed is not None][:2]
    agree = list(agreement(alone)) if len(alone) == 2 else None  # noqa: PLR2004 -- a pair
    return FreeDotsResult(print_shape(freed), agree)


def calibrate_table(result: CalibrateResult) -> object:
    """Return the document for people."""
    caption = f"rig: RMS {result.rms_px:.4f} px"
    if len(result.cameras) > 1:
        caption += f", epipolar RMS {result.epipolar_rms_px:.4f} px"
    bias = result.centre_bias_px
    caption += f"\ncorrected eccentricity: RMS {bias.rms:.4f} px, at most {bias.max:.4f} px"
    columns = ("RMS alone, in rig [px]", "fx, fy [px]", "cx, cy [px]", "lens", "views", "dots")
    table = Table(name_column("camera"), *columns)
    table.caption = caption
    for name, camera in result.cameras.items():
        (fx, _, cx), (_, fy, cy), _ = camera.K
        sigma = camera.sigma
        lens = f"{camera.lens} " + " ".join(f"{k:.5g}" for k in camera.dist)
        rms = f"{camera.rms_px:.4f}, {camera.rms_in_rig_px:.4f}"
        focal = f"{fx:.2f} ± {sigma.fx:.2f}, {fy:.2f} ± {sigma.fy:.2f}"
        middle = f"{cx:.2f} ± {sigma.cx:.2f}, {cy:.2f} ± {sigma.cy:.2f}"
        table.add_row(name, rms, focal, middle, lens, str(camera.views), str(camera.dots))
    parts: list[Table | Text | str] = [table]
    if result.lens_choice is not None:
        parts.append(lens_table(result.lens_choice))
    if result.outliers:
        parts.append(_outlier_table(result))
    parts.append(f"dots {result.dot_places.why}")
    if result.free_dots is not None:
        words = print_words(result.free_dots.shape)
        if result.free_dots.agreement is not None:
            x, y = result.free_dots.agreement
            words += f"\ncorrelation of the places by each camera alone: {x:.2f} along x, {y:.2f} along y"
        parts.append(Text(words))
    return Group(*parts)


def _outlier_table(result: CalibrateResult) -> Table:
    """Return the worst outliers for people."""
    title = f"outliers: {result.outlier_count}"
    table = Table(name_column("view"), name_column("camera"), "col, row", "off by [px]", title=title)
    for outlier in result.outliers[:_SHOWN_OUTLIERS]:
        x, y = outlier.off_px
        table.add_row(outlier.view, outlier.camera, f"{outlier.col}, {outlier.row}", f"{x:.2f}, {y:.2f}")
    if result.outlier_count > _SHOWN_OUTLIERS:
        table.caption = f"the worst {_SHOWN_OUTLIERS}; --json lists up to {MOST_OUTLIERS}"
    return table
