"""Slightly inconsistent views, whose contradiction exceeds the errors: left out by name."""

from collections.abc import Sequence
from itertools import combinations

from labcal.calibrate.agreement.hypotheses import inconsistent_views
from labcal.calibrate.agreement.pair import PairAgreement
from labcal.calibrate.single_calibration import SingleCalibration
from labcal.calibrate.view_agreement import InconsistentPicture, majority_outliers


def slight_contradictions(cameras: Sequence[SingleCalibration]) -> list[InconsistentPicture]:
    """Return the pictures of a few views in which cameras do not agree on where the target was.

    Only where the other views agree. Of three cameras or more those that agree with each other stay.

    Parameters
    ----------
    cameras : sequence of SingleCalibration
        Calibrated each with all its pictures.
    """
    numbers = list(combinations(range(len(cameras)), 2))
    pairs = [PairAgreement.of(cameras[one], cameras[other]) for one, other in numbers]
    against: dict[int, list[tuple[int, int]]] = {}
    reasons: dict[int, str] = {}
    for (one, other), pair in zip(numbers, pairs, strict=True):
        if pair is None:
            continue
        for place in inconsistent_views(pair):
            view = int(pair.poses.views[place])
            against.setdefault(view, []).append((one, other))
            reasons[view] = (
                f"cameras '{pair.first}' and '{pair.second}' contradict each other, by little, but more than "
                "errors explain, and agree in the other views: the target moved between the exposures, or a "
                "camera was moved"
            )
    return [
        InconsistentPicture(cameras[number].name, view, reasons[view])
        for view, pairs_apart in sorted(against.items())
        for number in majority_outliers(
            pairs_apart, [n for n, one in enumerate(cameras) if view in one.single.views]
        )
    ]
