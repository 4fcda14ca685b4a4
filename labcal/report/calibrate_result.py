"""Result of ``labcal calibrate``: the JSON document, and the same for people."""

from dataclasses import dataclass

import numpy as np
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
from labcal.calibrate.outlying_dots import OutlyingDots
from labcal.cameras.camera_pair import CameraPair
from labcal.correspond.boards_points import own_indices
from labcal.correspond.detections import Detections
from labcal.evaluate.print_shape import PrintShape, agreement, print_shape
from labcal.report.board_result import BoardResult, board_lines, board_results
from labcal.report.camera_result import CameraResult, camera_tables
from labcal.report.columns import name_column
from labcal.report.expectation_result import ExpectedErrorsResult, expectation_table, pair_lines
from labcal.report.inconsistent_result import InconsistentResult, inconsistent_result
from labcal.report.lens_table import lens_table
from labcal.report.print_words import print_words
from labcal.targets.board_set import BoardSet
from labcal.targets.catalogue import AnyTarget

MOST_OUTLIERS = 200
"""Outliers that the document lists, the worst ones."""
_SHOWN_OUTLIERS = 10
"""Those that people are shown."""


@dataclass(frozen=True)
class OutlierResult:
    """A dot that did not enter, since it is farther off than noise explains."""

    view: str
    camera: str
    col: int
    row: int
    off_px: list[float]
    """Measured minus predicted."""
    board: str | None = None
    """The board of col and row where the target has several; null of one target."""

    def place(self) -> str:
        """Return which dot it is, for a table."""
        on = "" if self.board is None else f"{self.board} "
        return f"{on}{self.col}, {self.row}"


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
    """Of ``--lens auto``, and where no lens is named; null where one is named, or a rig to start from is."""
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
    pairs: list[CameraPair]
    """Baseline of every two cameras and the angle between their axes, with their standard deviations."""
    expected_errors: ExpectedErrorsResult
    """Of points, where the target was."""
    boards: list[BoardResult] | None
    """Of boards side by side on one plate, where each was found; null for one target."""

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
        cameras={name: CameraResult.of(found, name) for name in found.rig.cameras},
        rms_px=found.rms_px,
        epipolar_rms_px=epipolar_rms_px,
        skipped=list(found.skipped),
        outlier_count=len(found.outliers),
        outliers=_outliers(found.outliers, target),
        centre_bias_px=found.eccentricity,
        stop_reason=found.reason.value,
        dot_places=found.dot_decision,
        free_dots=None if found.freed is None else _free_dots(found.freed, found),
        lens_choice=made.choice,
        held_out=list(made.held_out),
        calibrated_on=list(made.calibrated_on),
        triangulation_rms_px=None
        if found.rig.calibration is None
        else found.rig.calibration.triangulation_rms_px,
        inconsistent=inconsistent_result(found),
        warnings=list(made.warnings),
        pairs=list(found.pairs()),
        expected_errors=ExpectedErrorsResult.of(found.expected_errors()),
        boards=None if found.boards is None else board_results(found.boards, found.entering(detections)),
    )


def _outliers(outliers: OutlyingDots, target: AnyTarget) -> list[OutlierResult]:
    index, boards = outliers.index, np.full(len(outliers), None)
    if isinstance(target, BoardSet):
        index, boards = own_indices(index, target)
    columns = (outliers.view, outliers.camera, index, outliers.off_px, boards)
    lines = zip(*(column[:MOST_OUTLIERS].tolist() for column in columns), strict=True)
    return [
        OutlierResult(view, camera, col, row, off, board) for view, camera, (col, row), off, board in lines
    ]


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
    if bias.max > 0.0:
        caption += f"\ncorrected eccentricity: RMS {bias.rms:.4f} px, at most {bias.max:.4f} px"
    parts: list[Table | Text | Group | str] = [*camera_tables(result.cameras), Text(caption)]
    parts += [Text("\n".join(pair_lines(result.pairs))), expectation_table(result.expected_errors)]
    if result.lens_choice is not None:
        if result.lens_choice.trials:
            parts.append(lens_table(result.lens_choice))
        parts.append(Text(f"lens {result.lens_choice.lens}: {result.lens_choice.why}"))
    parts += _words_of_omitted(result)
    if result.outliers:
        parts.append(_outlier_table(result))
    parts.append(f"dots {result.dot_places.why}")
    if result.boards is not None:
        parts.append(Text("\n".join(board_lines(result.boards))))
    if result.free_dots is not None:
        words = print_words(result.free_dots.shape)
        if result.free_dots.agreement is not None:
            x, y = result.free_dots.agreement
            words += f"\ncorrelation of the places by each camera alone: {x:.2f} along x, {y:.2f} along y"
        parts.append(Text(words))
    return Group(*parts)


def _words_of_omitted(result: CalibrateResult) -> list[str]:
    """Return what the errors of points allow for beside noise and print, in words; nothing if nothing."""
    lacking = {camera.lens: camera.omitted for camera in result.cameras.values() if camera.omitted}
    return [
        f"errors of points allow for {', '.join(names)}, which the lens model '{lens}' does not have"
        for lens, names in lacking.items()
    ]


def _outlier_table(result: CalibrateResult) -> Table:
    """Return the worst outliers for people."""
    title = f"outliers: {result.outlier_count}"
    table = Table(name_column("view"), name_column("camera"), "col, row", "off by [px]", title=title)
    for outlier in result.outliers[:_SHOWN_OUTLIERS]:
        x, y = outlier.off_px
        table.add_row(outlier.view, outlier.camera, outlier.place(), f"{x:.2f}, {y:.2f}")
    if result.outlier_count > _SHOWN_OUTLIERS:
        table.caption = f"the worst {_SHOWN_OUTLIERS}; --json lists up to {MOST_OUTLIERS}"
    return table
