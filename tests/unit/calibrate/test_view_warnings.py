"""The warning that views disagree names the causes that were found, and no others."""

from dataclasses import replace

import numpy as np
import pytest

from labcal import examples, pipeline
from labcal.calibrate.budget.correlated_errors import CorrelatedErrors
from labcal.calibrate.budget.error_patterns import BOARD, SMOOTH, WHOLE
from labcal.calibrate.budget.variance_components import VarianceComponents
from labcal.calibrate.budget.view_dispersion import ViewDispersion
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_misfit import LensMisfit
from labcal.calibrate.view_warnings import disagreeing_views
from labcal.evaluate.verdict.calibration_evidence import calibration_evidence
from labcal.evaluate.verdict.of_calibration import calibration_verdict


@pytest.fixture(scope="module")
def found() -> HandheldCalibration:
    return pipeline.calibrate(examples.TARGET, examples.detections()).found


def disagreeing(found: HandheldCalibration, **sizes: float) -> HandheldCalibration:
    """Return the calibration as if its views disagreed by errors of these sizes."""
    variance = np.zeros(3)
    for name, kind in (("smooth", SMOOTH), ("board", BOARD), ("whole", WHOLE)):
        variance[kind] = sizes.get(name, 0.0) ** 2
    parts = VarianceComponents(1.0, 0.1, variance, np.zeros(3))
    free = found.sources.prior.size
    errors = CorrelatedErrors(parts, np.zeros((free, free)))
    return replace(found, sources=replace(found.sources, views=ViewDispersion(6.0, 0.2), correlated=errors))


def test_only_errors_that_were_found_are_named(found: HandheldCalibration) -> None:
    words = disagreeing_views(disagreeing(found, whole=0.015), "brown5")
    assert "6.0 times" in words
    assert "0.015 px (a camera moves" in words
    assert "0 px" not in words.replace("0.015 px", "")
    assert "um" not in words.split("squares")[1].replace("further", "")
    words = disagreeing_views(disagreeing(found, smooth=0.003, board=2e-4), "brown5")
    assert "0.2 um on the board" in words
    assert "0.003 px of neighbouring dots" in words
    assert "whole pictures" not in words


def test_without_any_of_them_the_usual_causes_are_named(found: HandheldCalibration) -> None:
    assert "Likely causes: the board" in disagreeing_views(disagreeing(found), "brown5")


def test_the_lens_is_named_as_its_test_says(found: HandheldCalibration) -> None:
    given = disagreeing(found, whole=0.01)
    assert "'brown5' is hardly the cause" in disagreeing_views(given, "brown5")
    left = replace(given.fits["left"], misfit=LensMisfit("rational8", 1e-5))
    simple = replace(given, fits={**given.fits, "left": left})
    assert "too simple for left, is one cause" in disagreeing_views(simple, "brown5")


def test_the_page_says_nothing_of_agreement_where_views_disagree() -> None:
    made = pipeline.calibrate(examples.TARGET, examples.detections())
    assert "without contradiction" in calibration_verdict(calibration_evidence(made)).sentence
    worse = replace(made, found=disagreeing(made.found, whole=0.015))
    reason = calibration_verdict(calibration_evidence(worse)).sentence
    assert "without contradiction" not in reason
    assert "6.0 times" in reason
