"""Diagnosis of the shoot while it is taken, beside the work of taking it."""

import threading
from collections.abc import Callable

from labcal.errors import LabcalError
from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.diagnosing import diagnosed
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import Finding
from labcal.live.shoot_dots import ShootDots

FEWEST_VIEWS = 4
"""Views from which on the dots are judged: three determine a rig and leave little to judge it by."""
UNFINISHED = frozenset({CheckName.TOO_FEW_VIEWS, CheckName.TOO_LITTLE_TILT, CheckName.POOR_COVERAGE})
"""Findings that every shoot has at first, and that the next pose mends."""


class Diagnoser:
    """Diagnoses the shoot after each view, in a thread of its own; the newest state alone, never a queue.

    Parameters
    ----------
    dots : ShootDots
    report : callable
        Called from the thread with the findings, the most harmful first.
    """

    def __init__(self, dots: ShootDots, report: Callable[[tuple[Finding, ...]], None]) -> None:
        self._dots, self._report = dots, report
        self._changed = threading.Condition()
        self._waiting: Evidence | None = None
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name="live-diagnosis", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End, after the diagnosis that is under way, whose findings are not reported."""
        with self._changed:
            self._stopped = True
            self._changed.notify_all()

    def look(self) -> None:
        """Diagnose the shoot as it is now; a state before it that waits is left out."""
        state = self._dots.evidence()
        with self._changed:
            self._waiting = state
            self._changed.notify_all()
        if state is None or _is_young(state):
            self._report(())

    def _run(self) -> None:
        while True:
            with self._changed:
                while self._waiting is None and not self._stopped:
                    self._changed.wait()
                if self._stopped or self._waiting is None:
                    return
                state, self._waiting = self._waiting, None
            findings = _findings(state)
            with self._changed:
                if self._waiting is None and not self._stopped:
                    self._report(findings)


def _is_young(state: Evidence) -> bool:
    return state.shoot is None or len(state.shoot.views()) < FEWEST_VIEWS


def _findings(state: Evidence) -> tuple[Finding, ...]:
    if _is_young(state):
        return ()
    try:
        findings = diagnosed(state).findings
    except LabcalError:  # nothing to judge by, or a picture was taken out meanwhile
        return ()
    return tuple(one for one in findings if one.check not in UNFINISHED)
