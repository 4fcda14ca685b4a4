"""The words of the live page about a calibrated rig."""

from collections.abc import Callable
from pathlib import Path

from labcal.calibrate.calibration import Calibration
from labcal.evaluate.verdict.calibration_evidence import calibration_evidence
from labcal.evaluate.verdict.of_calibration import calibration_verdict
from labcal.evaluate.verdict.verdict import Belief
from labcal.live.shown import Outcome
from labcal.wording import counted

_HEADS = {
    Belief.YES: "Your cameras are calibrated.",
    Belief.PARTLY: "Your cameras are calibrated, with a reservation.",
    Belief.NO: "The cameras are calibrated, but do not rely on it yet.",
}


def outcome_of(made: Calibration, files: dict[str, Path], phrase: Callable[[str], str]) -> Outcome:
    """Return what the page says about a calibration.

    Parameters
    ----------
    made : Calibration
    files : dict of str to Path
        Where everything is, by what it is: ``shoot``, ``rig`` and ``page``.
    phrase : callable
        What turns a message of the library into the reader's words.
    """
    verdict = calibration_verdict(calibration_evidence(made))
    reasons = f" {_sentence(phrase(verdict.reasons[0]))}" if verdict.reasons else ""
    figures = (
        ("Expect", phrase(verdict.expectation)),
        ("What limits it", phrase(verdict.limit)),
        ("To do better", phrase(verdict.advice)),
        ("Views", counted(len(made.found.views), "view")),
        ("Cameras", ", ".join(made.rig.cameras)),
        ("Lens model", made.lens),
    )
    places = (
        ("Pictures", str(files["shoot"].absolute())),
        ("Calibrated rig", str(files["rig"].absolute())),
        ("Page of it", str(files["page"].absolute())),
    )
    return Outcome(
        f"{_HEADS[verdict.belief]}{reasons}",
        figures,
        tuple(_sentence(phrase(one)) for one in made.warnings),
        places,
        f"labcal measure {files['rig']} PICTURES -o points.csv",
    )


def _sentence(text: str) -> str:
    """Return a message with a capital letter and a full stop."""
    return f"{text[:1].upper()}{text[1:]}{'' if text.endswith(('.', '?')) else '.'}"
