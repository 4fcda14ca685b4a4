"""Cameras that do not agree on where the target was: told with the cause, and good ones are not accused."""

import json
import pickle
from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.stats import chi2

from labcal.bench.solve.held_rig import CAMERAS, TARGET
from labcal.calibrate.agreement.causes import Calibrated, disagreement
from labcal.calibrate.agreement.finding import ContradictionError
from labcal.calibrate.agreement.hypotheses import times, together
from labcal.calibrate.agreement.pair import PairAgreement
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.single_calibration import SingleCalibration, calibrate_single
from labcal.cli.failure import FailureDocument, explain
from labcal.correspond.detections import Detections
from labcal.report.inconsistent_result import InconsistentResult
from labcal.run.json_text import to_json

Seen = Callable[..., Detections]

CENTRES = HandheldSettings(eccentricity_rounds=0)
KNOCK = np.array([1e-4, -5e-5, 5e-5, 0.1, -0.05, 0.1])
"""rad, mm: it moves dots by some 0.1 px, twice their noise."""


def pair_of(dots: Detections, lens: str = "brown5") -> PairAgreement:
    first, second = (calibrate_single(name, dots, TARGET, lens, CENTRES) for name in CAMERAS)
    found = PairAgreement.of(first, second)
    assert found is not None
    return found


def test_the_misfit_of_sound_views_is_a_chi_square(seen: Seen) -> None:
    pairs = [pair_of(seen(6, seed)) for seed in range(5)]
    total = sum(pair.misfit(together(pair)) for pair in pairs)
    freedom = 5 * 6 * 5
    assert chi2.ppf(1e-3, freedom) < total < chi2.isf(1e-3, freedom)
    smooth = [pair.smooth for pair in pairs]
    energy, expected = sum(one.energy for one in smooth), sum(one.freedom for one in smooth)
    assert chi2.ppf(1e-3, expected) < energy < chi2.isf(1e-3, expected)
    assert min(pair.chance(together(pair)) for pair in pairs) > 1e-3


def test_sound_views_are_not_accused(seen: Seen) -> None:
    found = calibrate_handheld(seen(8, 1), TARGET, "brown5", CENTRES)
    assert found.disagreement is None
    assert found.skipped == ()
    assert found.rig.calibration is not None
    assert found.rig.calibration.inconsistent == ()
    # A pair's rays miss by one of four components: half the noise, of both coordinates of a pixel.
    assert found.rig.calibration.triangulation_rms_px == pytest.approx(0.05 / np.sqrt(2.0), rel=0.1)


def test_a_camera_that_was_knocked_is_told_from_where_on(seen: Seen) -> None:
    found = calibrate_handheld(seen(8, 2, dict.fromkeys(range(4, 8), KNOCK)), TARGET, "brown5", CENTRES)
    assert found.disagreement is not None
    likeliest = found.disagreement.causes[0]
    assert likeliest.cause == "camera-moved"
    assert likeliest.views == ("pose-4", "pose-5", "pose-6", "pose-7")
    assert "before view 'pose-4'" in likeliest.why
    assert found.rig.calibration is not None
    assert found.rig.calibration.inconsistent[0] == "camera-moved"
    assert found.rms_px < 1.5 * found.rms_alone_px  # which an RMS would hardly tell


def test_a_camera_that_was_knocked_twice_is_told(seen: Seen) -> None:
    moved = dict.fromkeys(range(4, 8), KNOCK) | dict.fromkeys(range(8, 12), -2.0 * KNOCK)
    found = calibrate_handheld(seen(12, 2, moved), TARGET, "brown5", CENTRES)
    assert found.disagreement is not None
    assert found.disagreement.causes[0].cause == "camera-moved"
    assert "before view 'pose-4', 'pose-8'" in found.disagreement.causes[0].why


def test_a_target_that_moved_between_exposures_is_told(seen: Seen) -> None:
    random = np.random.default_rng(5)
    moved = {view: random.standard_normal(6) * np.abs(KNOCK) for view in range(8)}
    found = calibrate_handheld(seen(8, 3, moved), TARGET, "brown5", CENTRES)
    assert found.disagreement is not None
    assert found.disagreement.causes[0].cause == "unsynchronised"
    assert len(found.disagreement.views) > 4


def test_pictures_exchanged_in_half_of_the_views_are_told(seen: Seen) -> None:
    dots = seen(8, 4)
    later = np.isin(dots.view, [f"pose-{number}" for number in range(4, 8)])
    other = np.where(dots.camera == CAMERAS[0], CAMERAS[1], CAMERAS[0])
    swapped = replace(dots, camera=np.where(later, other, dots.camera))

    def alone(name: str, table: Detections) -> SingleCalibration:
        return calibrate_single(name, table, TARGET, "brown5", CENTRES)

    found = disagreement(Calibrated([alone(name, swapped) for name in CAMERAS], swapped, alone))
    assert found is not None
    (cause,) = found.causes
    assert cause.cause == "swapped-cameras"
    assert cause.views == ("pose-4", "pose-5", "pose-6", "pose-7")


def test_more_than_a_fifth_of_the_views_are_not_left_out_but_told(seen: Seen) -> None:
    """However far off they are: nothing says which are right, nor what happened."""
    knocked = seen(5, 2, dict.fromkeys((3, 4), 100.0 * KNOCK))
    found = calibrate_handheld(knocked, TARGET, "brown5", CENTRES)
    assert found.skipped == ()
    assert found.disagreement is not None
    cause = found.disagreement.causes[0]
    assert (cause.cause, cause.views) == ("camera-moved", ("pose-3", "pose-4"))
    assert "take new views: the 2 after it are too few" in cause.why

    one = seen(5, 2, {3: 100.0 * KNOCK})
    found = calibrate_handheld(one, TARGET, "brown5", CENTRES)
    assert found.disagreement is None
    assert all("pose-3" in reason for reason in found.skipped)


def test_where_no_rig_explains_the_dots_the_cause_is_told(seen: Seen) -> None:
    dots, some = seen(5, 4), ("pose-1", "pose-3")
    other = np.where(dots.camera == CAMERAS[0], CAMERAS[1], CAMERAS[0])
    swapped = replace(dots, camera=np.where(np.isin(dots.view, some), other, dots.camera))
    with pytest.raises(ContradictionError, match=r"in 2 of 5 views.*show it: pose-1, pose-3") as told:
        calibrate_handheld(swapped, TARGET, "brown-k1k2", CENTRES)
    again = pickle.loads(pickle.dumps(told.value))  # noqa: S301 -- as a worker process hands it on
    assert again.rms_alone_px == told.value.rms_alone_px < 0.2
    (cause,) = again.causes
    assert (cause.cause, cause.views, again.views) == ("swapped-cameras", some, some)
    assert again.times > 100.0
    document = to_json(FailureDocument(explain(again)))
    told_of = json.loads(document)["error"]["inconsistent"]
    assert set(told_of) == {field.name for field in fields(InconsistentResult)}
    assert told_of["rms_in_rig_px"] is None
    assert (told_of["causes"][0]["cause"], told_of["views"]) == ("swapped-cameras", list(some))


@pytest.mark.parametrize("seed", [0, 2, 5])
def test_three_views_that_differ_at_random_do_not_show_a_camera_that_moved(seen: Seen, seed: int) -> None:
    random = np.random.default_rng(seed)
    moved = {view: 3.0 * random.standard_normal(6) * np.abs(KNOCK) for view in range(3)}
    found = calibrate_handheld(seen(3, seed, moved), TARGET, "brown5", CENTRES)
    assert found.disagreement is not None
    assert found.disagreement.causes[0].cause == "unsynchronised"
    assert "have the name of one view" in found.disagreement.causes[0].why


def test_one_slightly_odd_view_is_left_out_by_name(seen: Seen) -> None:
    found = calibrate_handheld(seen(8, 6, {3: 2.0 * KNOCK}), TARGET, "brown5", CENTRES)
    assert found.disagreement is None
    assert [reason.partition(":")[0] for reason in found.skipped] == [
        f"view 'pose-3' of camera '{name}'" for name in CAMERAS
    ]


def test_another_lens_or_print_is_no_mistake(seen: Seen) -> None:
    dots = seen(8, 7)
    for lens in ("brown-k1k2", "pinhole"):
        found = calibrate_handheld(dots, TARGET, lens, CENTRES)
        assert found.disagreement is None, lens
        assert found.skipped == (), lens
    # Dots that stand 0.1 mm off on the print, the same in all pictures: as if others were measured.
    neighbour = np.random.default_rng(3).normal(scale=0.1, size=(TARGET.count, 2))
    number = dots.index[:, 1] * TARGET.cols + dots.index[:, 0]
    uneven = replace(dots, position=dots.position + neighbour[number])
    found = calibrate_handheld(uneven, TARGET, "brown5", CENTRES)
    assert found.fits["left"].scatter_px > 0.05
    assert found.disagreement is None


def test_a_knock_of_more_size_is_more_certain(seen: Seen) -> None:
    sizes = [0.0, 0.5, 1.0]
    found = [times(pair_of(seen(8, 8, dict.fromkeys(range(4, 8), size * KNOCK)))) for size in sizes]
    assert found[0] < 2.0 < found[1] < found[2]


def test_only_the_camera_that_loses_a_picture_is_calibrated_anew(
    seen: Seen, monkeypatch: pytest.MonkeyPatch
) -> None:
    dots = seen(6, 9)
    mirrored = (dots.view == "pose-2") & (dots.camera == "right")
    index = dots.index.copy()
    index[mirrored, 0] = TARGET.cols - 1 - index[mirrored, 0]
    called: list[str] = []

    def counted(name: str, *rest: object) -> object:
        called.append(name)
        return calibrate_single(name, *rest)  # type: ignore[arg-type]

    for home in ("handheld", "prepared_cameras"):
        monkeypatch.setattr(f"labcal.calibrate.{home}.calibrate_single", counted)
    found = calibrate_handheld(replace(dots, index=index), TARGET, "brown5", CENTRES)
    assert called == ["left", "right", "right"]
    assert len(found.skipped) == 1
    without = calibrate_handheld(dots.where(~mirrored), TARGET, "brown5", CENTRES)
    assert found.rig == without.rig  # to the last bit
