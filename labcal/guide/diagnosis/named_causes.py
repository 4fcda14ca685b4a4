"""Warnings of a calibration that name mistakes of its shoot, in the words of a diagnosis."""

from dataclasses import replace

import numpy as np

from labcal.calibrate.agreement.finding import Cause, CauseName
from labcal.calibrate.agreement.words import contradiction_message
from labcal.calibrate.calibration import Calibration
from labcal.correspond.detections import Detections
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.diagnosing import diagnosed
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import Finding
from labcal.targets.catalogue import AnyTarget

OF_GEOMETRY = (
    CheckName.SWAPPED_CAMERAS,
    CheckName.TURNED_TARGET,
    CheckName.UNSYNCHRONISED,
    CheckName.CAMERA_MOVED,
    CheckName.REFOCUSED,
    CheckName.ROLLING_SHUTTER,
    CheckName.BENT_BOARD,
    CheckName.WRONG_PITCH,
)
"""Checks of mistakes by which views do not go together."""


def is_doubtful(made: Calibration) -> bool:
    """Tell whether views do not go together, so that a calibration says so."""
    found = made.found
    of_two = any(fit.two_lenses is not None for fit in found.fits.values())
    return found.disagreement is not None or found.sources.views.is_beyond_chance or of_two


def with_named_causes(made: Calibration, dots: Detections, target: AnyTarget) -> Calibration:
    """Return a calibration of which warnings about contradictory views name the mistakes of a diagnosis.

    The rig stays as it is. A calibration without doubt is not looked at. Where the diagnosis finds no
    mistake, or not the one that the poses of the target speak of, the warnings stay as they are.

    Parameters
    ----------
    made : Calibration
    dots : Detections
        That it was made from, those of held-out views among them.
    target : AnyTarget
    """
    if not is_doubtful(made):
        return made
    entering = dots.where(np.isin(dots.view, list(made.found.views)))
    found = diagnosed(Evidence(target, entering, rig=made.rig), OF_GEOMETRY).findings
    if not found:
        return made
    causes = tuple(_cause(one) for one in found)
    doubt = made.found.disagreement
    if doubt is None:
        words = (f"{number}. {one.cause.value}: {one.why}" for number, one in enumerate(causes, start=1))
        return replace(made, warnings=(*made.warnings, *words))
    if doubt.causes[0].cause.value not in {one.check.value for one in found}:
        return made  # of a large mistake the poses of the target tell more than a linear model
    before = contradiction_message(made.found)
    named = replace(made.found, disagreement=replace(doubt, causes=causes))
    others = tuple(one for one in made.warnings if one not in before)
    return replace(made, found=named, warnings=(*contradiction_message(named), *others))


def _cause(one: Finding) -> Cause:
    return Cause(CauseName(one.check.value), f"{one.words} {one.mend}", one.cameras, one.views)
