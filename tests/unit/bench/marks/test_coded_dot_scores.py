"""Scores of coded dots: marks whose errors are drawn from their bound, with and without mistakes."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.groups import Findings
from labcal.bench.marks.coded_dots import CODE, CodedOutcome, coded_dot_checks, coded_outcome
from labcal.bench.marks.coded_picture import CodedPicture
from labcal.bench.marks.drawn_picture import Exposure
from labcal.detect.marks.picture_marks import MarkFlag, PictureMarks

COUNT = 5


@pytest.fixture
def picture() -> CodedPicture:
    """Return the truth of marks in a row, of which nothing is drawn."""
    exposure = Exposure((400, 300), np.eye(3), 1.0, np.zeros(2), 0.02)
    return CodedPicture(
        picture=np.zeros((300, 400), np.uint8),
        exposure=exposure,
        point=tuple(f"{CODE}-{number}" for number in range(COUNT)),
        centroid=np.stack([60.3 + 70.0 * np.arange(COUNT), np.full(COUNT, 150.8)], axis=-1),
        shape=np.tile(np.diag([12.0**2, 8.0**2]), (COUNT, 1, 1)),
        measurable=np.arange(COUNT) != 2,
        hidden=np.where(np.arange(COUNT) == 3, 0.2, 0.0),
    )


def marks_of(picture: CodedPicture, off: np.ndarray) -> PictureMarks:
    """Return a picture's true marks, off by so many px."""
    count = len(picture.point)
    return PictureMarks(
        size=(400, 300),
        point=picture.point,
        position=picture.centroid + off,
        covariance=np.tile(np.eye(2) * 1e-4, (count, 1, 1)),
        flag=(MarkFlag.OK,) * count,
        seen_at=picture.centroid,
        outline=picture.shape,
    )


def drawn_outcome(picture: CodedPicture) -> CodedOutcome:
    """Return errors drawn 2000 times from the sharper bound of a picture's first mark."""
    one = coded_outcome(picture, marks_of(picture, np.zeros(2)))
    bound, sharper = one.bound[:1], one.sharper_bound[:1]
    drawn = np.random.default_rng(5).normal(0.0, 1.0, (2000, 2)) @ np.linalg.cholesky(sharper[0]).T
    bound, sharper = (np.repeat(C, len(drawn), axis=0) for C in (bound, sharper))
    return replace(one, error=drawn, covariance=sharper, bound=bound, sharper_bound=sharper)


def value(findings: Findings, words: str) -> float:
    """Return the one figure whose name ends so."""
    found = [one.value for one in (*findings.checks, *findings.references) if one.name.endswith(words)]
    assert len(found) == 1
    return float(found[0] if found[0] is not None else np.nan)


def test_true_marks_are_found_and_none_is_wrong(picture: CodedPicture) -> None:
    outcome = coded_outcome(picture, marks_of(picture, np.array([0.5, 0.0])))
    assert outcome.found.all()
    assert outcome.wrong == 0
    assert len(outcome.error) == COUNT - 1
    np.testing.assert_allclose(outcome.error, np.broadcast_to([0.5, 0.0], outcome.error.shape), atol=1e-9)


def test_names_of_other_marks_are_wrong_and_what_is_not_measured_is_missed(picture: CodedPicture) -> None:
    marks = marks_of(picture, np.zeros(2))
    names = tuple("ring-23-9999" if k == 0 else name for k, name in enumerate(marks.point))
    outcome = coded_outcome(picture, replace(marks, point=names))
    assert outcome.wrong == 1
    assert (~outcome.found).sum() == 1
    flags = tuple(MarkFlag.BAD_FIT if k == 0 else flag for k, flag in enumerate(marks.flag))
    outcome = coded_outcome(picture, replace(marks, flag=flags))
    assert outcome.wrong == 0
    assert (~outcome.found).sum() == 1


def test_a_fit_that_weights_pixels_may_be_better_than_the_bound_of_alike_ones(picture: CodedPicture) -> None:
    findings = coded_dot_checks("x", [drawn_outcome(picture)])
    assert value(findings, "the bound of a fit that weights pixels by their noise") == pytest.approx(
        1.0, abs=0.05
    )
    assert 0.75 < value(findings, "over the Cramer-Rao bound") < 0.95
    assert value(findings, "over what is stated") == pytest.approx(1.0, abs=0.05)
    assert value(findings, "off chi-square, standard deviations") < 3.3
