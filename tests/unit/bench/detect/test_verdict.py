from dataclasses import replace

import numpy as np

from labcal.bench.detect.dot_visibility import DotVisibility
from labcal.bench.detect.verdict import verdict_of
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag
from labcal.targets.grid import Polarity

COLS, ROWS, PITCH = 4, 3, 20.0


def truth() -> DotVisibility:
    row, col = np.divmod(np.arange(COLS * ROWS), COLS)
    n = COLS * ROWS
    return DotVisibility(
        index=np.stack([col, row], axis=-1),
        centroid=PITCH * (np.stack([col, row], axis=-1) + 1.0),
        minor_px=np.full(n, 6.0),
        pitch_px=np.full(n, PITCH),
        hidden=np.zeros(n),
        in_frame=np.ones(n, dtype=bool),
        measurable=np.ones(n, dtype=bool),
        ring=np.arange(n) < 3,
    )


def detected(seen: DotVisibility) -> PictureDots:
    n = len(seen.index)
    return PictureDots(
        size=(120, 100),
        polarity=Polarity.BLACK_ON_WHITE,
        refusal=None,
        index=seen.index.copy(),
        has_id=np.ones(n, dtype=bool),
        position=seen.centroid + 0.05,
        covariance=np.tile(np.eye(2), (n, 1, 1)),
        misfit=np.ones(n),
        flag=(DotFlag.OK,) * n,
        seen_at=seen.centroid + 0.05,
        outline=np.tile(36.0 * np.eye(2), (n, 1, 1)),
    )


def test_a_perfect_answer_has_nothing_wrong() -> None:
    verdict = verdict_of(detected(truth()), truth(), COLS)
    assert (verdict.found, verdict.measurable, verdict.wrong_ids, verdict.false_dots) == (12, 12, 0, 0)
    np.testing.assert_allclose(verdict.worst_px, 0.05 * np.sqrt(2.0))


def test_ids_that_are_a_step_off_are_all_wrong() -> None:
    dots = detected(truth())
    shifted = replace(dots, index=dots.index + np.array([1, 0]))
    verdict = verdict_of(shifted, truth(), COLS)
    # Those of the last column fall off the grid; they are measured, so a wrong id all the same.
    assert (verdict.found, verdict.wrong_ids, verdict.false_dots) == (0, 12, 0)


def test_a_measured_dot_some_pixels_off_is_wrong_and_one_only_seen_there_is_not() -> None:
    dots = detected(truth())
    position = dots.position.copy()
    position[5] += [4.0, 0.0]
    flag = list(dots.flag)
    assert verdict_of(replace(dots, position=position), truth(), COLS).wrong_ids == 1
    flag[5], position[5] = DotFlag.BAD_FIT, np.nan
    seen_at = dots.seen_at.copy()
    seen_at[5] += [4.0, 0.0]
    hidden = replace(dots, position=position, seen_at=seen_at, flag=tuple(flag))
    verdict = verdict_of(hidden, truth(), COLS)
    assert (verdict.wrong_ids, verdict.astray) == (0, 0)
    seen_at[5] += [PITCH, 0.0]
    verdict = verdict_of(replace(hidden, seen_at=seen_at), truth(), COLS)
    assert (verdict.wrong_ids, verdict.astray) == (0, 1)


def test_a_measured_dot_is_misled_beyond_its_uncertainty() -> None:
    dots = detected(truth())
    position, covariance = dots.position.copy(), 1e-3 * dots.covariance
    position[[1, 2]] += [[0.3, 0.0], [0.1, 0.0]]
    verdict = verdict_of(replace(dots, position=position, covariance=covariance), truth(), COLS)
    assert (verdict.measured, verdict.misled) == (12, 1)
    assert (
        verdict_of(replace(dots, position=position), truth(), COLS).misled == 0
    )  # it said that it was unsure


def test_a_measured_dot_is_false_where_none_is_or_something_covers_it() -> None:
    dots = detected(truth())
    nowhere = dots.position.copy()
    nowhere[0] = [30.0, 30.0]  # between four dots
    assert verdict_of(replace(dots, position=nowhere), truth(), COLS).false_dots == 1
    seen = truth()
    hidden = seen.hidden.copy()
    hidden[[2, 3]] = [0.4, 0.6]
    covered = replace(seen, hidden=hidden, measurable=seen.measurable & (hidden == 0.0))
    verdict = verdict_of(dots, covered, COLS)
    assert (verdict.false_dots, verdict.measurable, verdict.found) == (1, 10, 10)


def test_a_refused_picture_finds_nothing() -> None:
    dots = detected(truth())
    lost = replace(dots, flag=(DotFlag.NO_ID,) * 12, has_id=np.zeros(12, dtype=bool))
    verdict = verdict_of(lost, truth(), COLS)
    assert (verdict.found, verdict.wrong_ids, verdict.false_dots) == (0, 0, 0)
    assert np.isnan(verdict.worst_px)
