"""The page of ``labcal calibrate``: the verdict, the rig in space, residuals, pictures."""

import numpy as np

from labcal.calibrate.calibration import Calibration
from labcal.calibrate.eccentricity import centred
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.errors import InputError
from labcal.evaluate.verdict.calibration_evidence import calibration_evidence
from labcal.evaluate.verdict.of_calibration import calibration_verdict
from labcal.geometry.poses import transform
from labcal.report.calibrate_result import calibrate_result
from labcal.report.calibration_figures import camera_table, expectation_parts, further_parts
from labcal.report.calibration_residuals import residual_parts, worst_pictures
from labcal.report.dot_words import dot_words
from labcal.report.error_map import error_map
from labcal.report.page.beside import Beside
from labcal.report.page.chart import Chart
from labcal.report.page.document import Page, Section
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose
from labcal.report.page.space_view import SpaceView
from labcal.report.page.statement import Statement
from labcal.report.page_maker import PageMaker
from labcal.report.space import Space
from labcal.report.target_outline import target_outline
from labcal.targets.catalogue import AnyTarget
from labcal.wording import counted

_PAIR = 2


def calibration_page(made: Calibration, detections: Detections, target: AnyTarget, maker: PageMaker) -> Page:
    """Return the page of a calibration from dots of a target.

    Parameters
    ----------
    made : Calibration
    detections : Detections
        What it was made from; pictures that they name and that can be read are shown.
    target : AnyTarget
    maker : PageMaker
    """
    found = made.found
    result = calibrate_result(made, detections, target)
    verdict = calibration_verdict(calibration_evidence(made))
    names = list(found.rig.cameras)
    space = _space(found, detections, target)
    sections = [
        Section("In space", [SpaceView("space", space, _IN_SPACE), *_volume_parts(space)]),
        Section("Residuals", [Prose((_RESIDUALS,)), Beside(tuple(residual_parts(found)))]),
        Section("Errors to expect", expectation_parts(result)),
        Section("Cameras", [camera_table(result)]),
        Section("Pictures", [Prose((_PICTURES,)), Beside(tuple(worst_pictures(found, detections)))]),
    ]
    further = further_parts(result, found.freed)
    if further:
        sections.append(Section("Further figures", further))
    return Page(
        title=f"Calibration of {', '.join(names)}",
        heading=f"Calibration of {', '.join(names)}",
        lead=f"{counted(len(found.views), 'view')} of {target.name}, held in the hand; lens {made.lens}; "
        f"dots {maker.phrase(found.dot_decision.why)}.",
        sections=sections,
        provenance=maker.provenance,
        opening=[Statement(verdict, maker.phrase), *maker.notes(made.warnings)],
    )


_IN_SPACE = (
    "Cameras with their fields of view, the target in every view, and its dots where the rays of all cameras "
    "meet. An error vector leads from there to where the adjustment places the dot."
)
_OVER_THE_VOLUME = (
    "RMS distance between where the rays of a dot meet and where the adjustment places it, in each cell: "
    "from the front, from above and from the side."
)
_RESIDUALS = (
    "A residual is the predicted minus the measured position of a dot. Thin lines are single dots, which "
    "show noise. A thick arrow is the mean of its cell: noise averages out there, so that thick arrows that "
    "point the same way as their neighbours show a wrong lens or a bent print."
)
_PICTURES = (
    "Of each camera the picture with the largest RMS residual, with its dots in green and residuals in red."
)


def _volume_parts(space: Space) -> list[Part]:
    """Return where in the volume the rays of all cameras meet how well."""
    if len(space.vectors) == 0:
        return []
    return [Chart("error-map", error_map(space.points, space.error_mm), _OVER_THE_VOLUME)]


def _space(found: HandheldCalibration, detections: Detections, target: AnyTarget) -> Space:
    """Return the rig, the target in all views, and its dots with their errors where two cameras saw them."""
    cameras = {name: found.rig.camera(name) for name in found.rig.cameras}
    outline = target_outline(target)
    outlines = [transform(T, outline) for T in found.T_world_target]
    if len(cameras) < _PAIR:
        return Space(cameras, outlines, found.places)
    matches = match(found.entering(detections), tuple(cameras))
    if found.disagreement is None and len(matches):
        try:
            matches, _ = centred(list(cameras.values()), matches, target)
        except InputError:  # points are nowhere near a target
            matches = matches.where(np.zeros(len(matches), dtype=bool))
    met = triangulate(list(cameras.values()), matches.q, matches.covariance)
    of_view = dict(zip(found.views, found.T_world_target, strict=True))
    numbers = matches.index[:, 1] * target.cols + matches.index[:, 0]
    placed = np.array(
        [
            transform(of_view[view], found.dots[i])
            for view, i in zip(matches.view.tolist(), numbers.tolist(), strict=True)
        ]
    ).reshape(-1, 3)
    labels = [
        f"{view}, {dot}" for view, dot in zip(matches.view, dot_words(matches.index, target), strict=True)
    ]
    ok = met.ok
    labels = [label for label, good in zip(labels, ok.tolist(), strict=True) if good]
    return Space(cameras, outlines, met.point[ok], placed[ok] - met.point[ok], labels)
