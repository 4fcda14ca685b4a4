"""A set of rendered pictures of a hand-held target, without and with each possible mistake."""

from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.calibrate.agreement.finding import CauseName, ContradictionError
from labcal.calibrate.handheld import calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.correspond.detections import Detections
from labcal.correspond.dot_source import dots_of_shoot
from labcal.errors import InputError
from labcal.evaluate.own_lengths import errors_of_lengths
from labcal.reconstruct.reconstruction import reconstruct_points
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.report.values import Measured
from labcal.run.progress import NoProgress
from labcal.scene.catalogue import load_scene
from labcal.scene.mistakes import Mistake
from labcal.targets.catalogue import AnyTarget

SCENE, VIEWS, SPP, LENS = "webcam-handheld", 8, 8, "brown5"
SIZES = {
    Mistake.SWAPPED_CAMERAS: 1.0,
    Mistake.CAMERA_KNOCKED: 0.02,
    Mistake.UNSYNCHRONISED: 0.03,
}
"""About where lengths are off by 20% more than without; of exchanged pictures the later half."""
_CAUSES = {
    Mistake.SWAPPED_CAMERAS: CauseName.SWAPPED_CAMERAS,
    Mistake.CAMERA_KNOCKED: CauseName.CAMERA_MOVED,
    Mistake.UNSYNCHRONISED: CauseName.UNSYNCHRONISED,
}


@dataclass(frozen=True)
class SetOfPictures:
    """The settings of a set."""

    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"set-{self.seed}"


class MistakeFigures(BaseModel):
    """The result for one mistake."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    told: bool
    """True if an inconsistency is reported."""
    named: bool
    """True if the most likely cause is the mistake."""
    lengths: Measured
    """RMS error of the target's own lengths over that without the mistake; NaN where nothing fits."""


class SetFigures(BaseModel):
    """The result for one set."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    accused: bool
    """True if an inconsistency is reported without any mistake."""
    mistakes: dict[Mistake, MistakeFigures]


def evaluated_set(wanted: SetOfPictures) -> SetFigures:
    """Render a set without and with mistakes, calibrate from each, and return the reports.

    Exchanged pictures are those of the set as meant, exchanged, as the renderer delivers them.
    """
    target = load_scene(SCENE).target
    good = _detected(wanted, None)
    calibrated = calibrate_handheld(good, target, LENS)
    usual = _length_error(calibrated, good, target)
    mistakes = {}
    for mistake, cause in _CAUSES.items():
        swapped = mistake is Mistake.SWAPPED_CAMERAS
        dots = _exchanged(good) if swapped else _detected(wanted, mistake)
        mistakes[mistake] = _figures(dots, target, cause, usual)
    return SetFigures(accused=_reported(calibrated), mistakes=mistakes)


def _figures(dots: Detections, target: AnyTarget, cause: CauseName, usual: float) -> MistakeFigures:
    """Calibrate from a set with a mistake; `usual` is the error of lengths without it."""
    try:
        found = calibrate_handheld(dots, target, LENS)
    except ContradictionError as error:
        named = error.disagreement.causes[0].cause is cause
        return MistakeFigures(told=True, named=named, lengths=float("nan"))
    doubt = found.disagreement
    return MistakeFigures(
        told=_reported(found),
        named=doubt is not None and doubt.causes[0].cause is cause,
        lengths=_length_error(found, dots, target) / usual,
    )


def _reported(found: HandheldCalibration) -> bool:
    return found.disagreement is not None or bool(found.skipped)


def _detected(wanted: SetOfPictures, mistake: Mistake | None) -> Detections:
    """Render and detect, and return the dots; pictures are removed.

    They are where temporary files are: a worker of a cluster does not see the folder of the results.
    """
    changes = () if mistake is None else (f"mistake={mistake}", f"mistake_size={SIZES[mistake]}")
    settings = RenderSettings(spp=SPP, views=VIEWS, seed=wanted.seed)
    with TemporaryDirectory(prefix="labcal-set-") as home:
        shoot = render_shoot(load_scene(SCENE, changes), Path(home, "shoot"), settings, NoProgress())
        return dots_of_shoot(shoot, 1, NoProgress())


def _exchanged(dots: Detections) -> Detections:
    """Return the dots with the two cameras' names exchanged from the middle view on."""
    first, second = dots.cameras
    later = np.isin(dots.view, dots.views[len(dots.views) // 2 :])
    other = np.where(dots.camera == first, second, first)
    return replace(dots, camera=np.where(later, other, dots.camera))


def _length_error(found: HandheldCalibration, dots: Detections, target: AnyTarget) -> float:
    """Return the RMS error of all lengths on the target, mm; NaN where nothing can be reconstructed."""
    try:
        points = reconstruct_points(found.rig, dots, target)
        return errors_of_lengths(points, target).length_error_mm.rms
    except InputError:
        return float("nan")
