"""The chain from pictures to errors in millimetres: the work of every command as one function.

::

    render ─► SHOOT ─► detect ─► fit, or calibrate ─► reconstruct ─► evaluate

A command line parses, calls the function of its verb's name, and prints; a notebook calls the same functions.
Paths are text or :class:`os.PathLike`; where a shoot, a table, cameras or points are wanted, their path does,
too. Nothing is printed: what a person should not miss is in the `warnings` of what is returned, and
`progress` receives the state of the work.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from labcal.pipeline.acceptance import certify
from labcal.pipeline.calibration import calibrate, fit, training_of
from labcal.pipeline.capturing import capture
from labcal.pipeline.check import check
from labcal.pipeline.comparison import compare
from labcal.pipeline.detection import detect, inspect, measure_pictures
from labcal.pipeline.diagnosis import diagnose
from labcal.pipeline.evaluation import evaluate
from labcal.pipeline.held_out import evaluate_held_out
from labcal.pipeline.live_capture import capture_live
from labcal.pipeline.marks import find_marks
from labcal.pipeline.named_points import measure
from labcal.pipeline.other_programs import convert, understand, undistort
from labcal.pipeline.reconstruction import reconstruct
from labcal.pipeline.rehearsal import rehearse
from labcal.pipeline.rendering import render
from labcal.pipeline.studies import bench, reproduce
from labcal.pipeline.target_design import make_target
from labcal.pipeline.twin import twin

if TYPE_CHECKING:
    from labcal.bench.settings import BenchSettings
    from labcal.calibrate.epipolar_residual import epipolar_rms
    from labcal.calibrate.handheld import HandheldSettings
    from labcal.cameras.interop.conversion import ConvertSettings
    from labcal.capture.guide_settings import GuideSettings
    from labcal.capture.settings import CaptureSettings, SourceSettings
    from labcal.correspond.mark_search import MarkSearch
    from labcal.correspond.measure import detections_of
    from labcal.correspond.picture_set import open_pictures
    from labcal.correspond.undistortion import UndistortSettings
    from labcal.detect.settings import DetectSettings, detect_settings
    from labcal.estimators.fit_settings import FitSettings
    from labcal.estimators.fitting import estimators_of, fit_methods
    from labcal.evaluate.acceptance.certify_settings import CertifySettings
    from labcal.evaluate.acceptance.length_plan import plan_lengths
    from labcal.evaluate.comparison.compare_settings import CompareSettings
    from labcal.guide.check_settings import CheckSettings
    from labcal.guide.rehearsal.settings import RehearseSettings
    from labcal.guide.target_design.question import TargetQuestion
    from labcal.guide.twin.settings import TwinSettings
    from labcal.live.settings import LiveSettings
    from labcal.paper.reproduce import ReproduceSettings
    from labcal.reconstruct.found_marks import FoundMarks
    from labcal.reconstruct.measure_settings import MeasureSettings
    from labcal.render.shoot import RenderSettings
    from labcal.report.mark_overlays import write_mark_overlays
    from labcal.report.overlays import write_overlays
    from labcal.report.page.output import PageOutput

__all__ = [
    "BenchSettings",
    "CaptureSettings",
    "CertifySettings",
    "CheckSettings",
    "CompareSettings",
    "ConvertSettings",
    "DetectSettings",
    "FitSettings",
    "FoundMarks",
    "GuideSettings",
    "HandheldSettings",
    "LiveSettings",
    "MarkSearch",
    "MeasureSettings",
    "PageOutput",
    "RehearseSettings",
    "RenderSettings",
    "ReproduceSettings",
    "SourceSettings",
    "TargetQuestion",
    "TwinSettings",
    "UndistortSettings",
    "bench",
    "calibrate",
    "capture",
    "capture_live",
    "certify",
    "check",
    "compare",
    "convert",
    "detect",
    "detect_settings",
    "detections_of",
    "diagnose",
    "epipolar_rms",
    "estimators_of",
    "evaluate",
    "evaluate_held_out",
    "find_marks",
    "fit",
    "fit_methods",
    "inspect",
    "make_target",
    "measure",
    "measure_pictures",
    "open_pictures",
    "plan_lengths",
    "reconstruct",
    "rehearse",
    "render",
    "reproduce",
    "training_of",
    "twin",
    "understand",
    "undistort",
    "write_mark_overlays",
    "write_overlays",
]

_HOMES = {
    "BenchSettings": "labcal.bench.settings",
    "CaptureSettings": "labcal.capture.settings",
    "CertifySettings": "labcal.evaluate.acceptance.certify_settings",
    "CheckSettings": "labcal.guide.check_settings",
    "CompareSettings": "labcal.evaluate.comparison.compare_settings",
    "ConvertSettings": "labcal.cameras.interop.conversion",
    "DetectSettings": "labcal.detect.settings",
    "FitSettings": "labcal.estimators.fit_settings",
    "FoundMarks": "labcal.reconstruct.found_marks",
    "GuideSettings": "labcal.capture.guide_settings",
    "HandheldSettings": "labcal.calibrate.handheld",
    "LiveSettings": "labcal.live.settings",
    "MarkSearch": "labcal.correspond.mark_search",
    "MeasureSettings": "labcal.reconstruct.measure_settings",
    "PageOutput": "labcal.report.page.output",
    "RehearseSettings": "labcal.guide.rehearsal.settings",
    "RenderSettings": "labcal.render.shoot",
    "ReproduceSettings": "labcal.paper.reproduce",
    "SourceSettings": "labcal.capture.settings",
    "TargetQuestion": "labcal.guide.target_design.question",
    "TwinSettings": "labcal.guide.twin.settings",
    "UndistortSettings": "labcal.correspond.undistortion",
    "detect_settings": "labcal.detect.settings",
    "detections_of": "labcal.correspond.measure",
    "epipolar_rms": "labcal.calibrate.epipolar_residual",
    "estimators_of": "labcal.estimators.fitting",
    "plan_lengths": "labcal.evaluate.acceptance.length_plan",
    "open_pictures": "labcal.correspond.picture_set",
    "fit_methods": "labcal.estimators.fitting",
    "write_mark_overlays": "labcal.report.mark_overlays",
    "write_overlays": "labcal.report.overlays",
}
"""Public names, imported when first asked for: detection needs no SciPy, a rig no scikit-learn."""


def __getattr__(name: str) -> object:
    """Return what is at home elsewhere."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted({*globals(), *_HOMES})
