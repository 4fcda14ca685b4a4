"""Shoots taken on a page in a browser, which ends in the calibrated rig."""

import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from labcal.arguments import settings_of
from labcal.errors import InputError, LabcalError
from labcal.paths import AnyPath, as_path
from labcal.run.progress import Progress, progress_of
from labcal.targets.catalogue import AnyTargets
from labcal.targets.one_kind import single_board
from labcal.wording import counted

if TYPE_CHECKING:
    from pathlib import Path

    from labcal.calibrate.calibration import Calibration
    from labcal.capture.settings import CaptureSettings
    from labcal.guide.diagnosis.finding import Finding
    from labcal.live.board import Board
    from labcal.live.result import CapturedLive
    from labcal.live.settings import LiveSettings
    from labcal.live.shoot_dots import ShootDots

LAST_LOOK_S = 3.0
"""After a failure the page is served so long, that it can tell of it."""
INTERRUPTED_LOOK_S = 0.7
"""After Ctrl-C the page is served so long, that it can say so."""
_LOOK_S = 0.2


def capture_live(
    sources: str | Sequence[str],
    folder: AnyPath,
    target: AnyTargets | None = None,
    settings: "CaptureSettings | None" = None,
    live: "LiveSettings | None" = None,
    progress: Progress | None = None,
) -> "CapturedLive":
    """Take a shoot on a page in a browser on this computer, and calibrate its cameras.

    The page shows what the cameras see, the dots that are found, the pose to take next and the 3-D error
    that is reached. A person takes each view there, or lets it be taken when the target is still, and ends
    with the calibrated rig and its page. It is served on 127.0.0.1 only, to whoever has its token.

    Parameters
    ----------
    sources : str or sequence of str
        As of :func:`capture`.
    folder : path
        The shoot to appear.
    target : str or AnyTarget, optional
        The target that the pictures show, which a scene and a shoot that is replayed bring with them. Without
        it the page asks for the code of a print, and goes on with the target that it tells.
    settings : CaptureSettings, optional
        With `views`, the capture ends after so many; else when the person says so.
    live : LiveSettings, optional
        The port, a function that receives the address, and the place of the rig.
    progress : Progress, optional

    Returns
    -------
    CapturedLive
        The shoot, and the calibration from it.

    Raises
    ------
    DeviceError
        A camera is missing or fails, the port is in use, or the extra ``page`` is not installed; the views
        taken before are whole.
    InputError
        An address or a setting cannot be used, or nothing can be calibrated from the views, such as where
        nothing tells the target.
    OutputError
        The shoot, the rig or its page exists already, or may not be written.

    Examples
    --------
    >>> from labcal import pipeline
    >>> live = pipeline.LiveSettings(opened=print)
    >>> made = pipeline.capture_live("sim:webcam-handheld", "shoot", live=live)  # doctest: +SKIP
    http://127.0.0.1:43117/?token=...
    """
    from labcal.capture.capturing import capture_shoot
    from labcal.capture.guide_settings import GuideSettings
    from labcal.capture.preview import Previewed
    from labcal.capture.settings import CaptureSettings
    from labcal.live.board import Board
    from labcal.live.diagnoser import Diagnoser
    from labcal.live.operator import Operator
    from labcal.live.result import CapturedLive
    from labcal.live.server import require_server, served
    from labcal.live.settings import LiveSettings
    from labcal.live.shoot_dots import ShootDots
    from labcal.pipeline.capturing import planned_capture

    how = settings_of(live, LiveSettings)
    require_server()
    given = settings_of(settings, CaptureSettings)
    if given.guide is None and given.stage is None:
        given = replace(given, guide=GuideSettings())
    source, run = planned_capture(sources, target, given, None)
    if run.target is not None:
        single_board(run.target, "The page of a capture takes", "Or capture without the page.")
    dots = ShootDots(as_path(folder), run.target)
    ending = _Ending(dots, as_path(folder), how, Board(), force=run.settings.force)
    previewed = Previewed(source)
    operator = Operator(ending.board, previewed, run.target, ending.finish, ending.page.phrase)
    operator.keep_dots(dots, Diagnoser(dots, ending.show_findings))
    if run.advisor is not None:
        operator.guide_by(run.advisor, run.show)
    with served(ending.board, how.port) as page:
        how.opened(page.address)
        with closing(operator), ending.failures_shown():
            ending.board.show(wanted_views=run.settings.views or len(run.stage) or None)
            captured = capture_shoot(
                previewed, ending.folder, replace(run, attendant=operator), progress_of(progress)
            )
            made = ending.made = ending.made or ending.calibrated()
        ending.show()
        ending.linger()
    return CapturedLive(captured, made, ending.rig, as_path(ending.page.path))


class _Ending:
    """The end of a capture: the calibration, its files, and what the page shows of them."""

    def __init__(
        self, dots: "ShootDots", folder: "Path", how: "LiveSettings", board: "Board", *, force: bool
    ) -> None:
        from labcal.cameras.rig_file import KIND
        from labcal.report.page.output import PageOutput
        from labcal.run.claims import FileOutput, claim_outputs

        self._dots = dots
        self.folder, self.board, self._how, self._force = folder, board, how, force
        beside = folder.with_name(f"{folder.name}-rig")
        self.rig = beside.with_suffix(".json") if how.rig is None else as_path(how.rig)
        given = beside.with_suffix(".html") if how.page is None else how.page
        self.page: PageOutput = replace(PageOutput.of(given), force=force or PageOutput.of(given).force)
        self.made: Calibration | None = None
        claim_outputs([FileOutput(self.rig, KIND), self.page.file], [], force=force)

    @contextmanager
    def failures_shown(self) -> Iterator[None]:
        """Show a failure, or Ctrl-C, on the page before it goes on to the caller."""
        from labcal.live.shown import Phase

        try:
            yield
        except LabcalError as error:
            reason = self.phrase(error)
            self.board.show(phase=Phase.FAILED, request="The capture has stopped", hint="", error=reason)
            time.sleep(LAST_LOOK_S)
            raise
        except KeyboardInterrupt:
            views = counted(self.board.shown.views, "view")
            kept = f"The shoot {self.folder} keeps {views}. The same command goes on with it."
            words = "Stopped at the terminal (Ctrl-C)"
            self.board.show(phase=Phase.FAILED, request=words, hint="", error=kept)
            time.sleep(INTERRUPTED_LOOK_S)
            raise

    def phrase(self, error: Exception) -> str:
        """Return a message in the reader's words."""
        return self.page.phrase(str(error))

    def finish(self) -> bool:
        """Calibrate; False, with the reason on the page, where these views do not do."""
        from labcal.errors import OutputError

        try:
            self.made = self.calibrated()
        except OutputError:
            raise
        except LabcalError as error:
            words = f"These views could not be calibrated yet: {self.phrase(error)} Take more, and try again."
            self.board.show(error=words)
            return False
        return True

    def calibrated(self) -> "Calibration":
        """Calibrate from the views that are in the shoot, and write the rig and its page."""
        from labcal.cameras.rig_file import write_rig
        from labcal.correspond.measure import detections_of
        from labcal.live.board_progress import BoardProgress
        from labcal.live.shown import Phase
        from labcal.pipeline.calibration import calibrate

        words = "Calibrating. This takes a minute or so; the target can rest"
        self.board.show(phase=Phase.CALIBRATE, request=words, hint="", error="", work=("", 0, 0))
        _, found = self._dots.all()
        made = calibrate(
            self.folder, detections_of(found), progress=BoardProgress(self.board), page=self.page
        )
        write_rig(self.rig, made.rig, force=self._force)
        return made

    def show_findings(self, findings: "Sequence[Finding]") -> None:
        """Show what is wrong with the shoot and how to mend it, the most harmful first."""
        self.board.show(findings=tuple(self.page.phrase(f"{one.words} {one.mend}") for one in findings))

    def _findings(self, made: "Calibration") -> "tuple[Finding, ...]":
        """Return the findings of the diagnosis of the whole shoot."""
        from labcal.guide.diagnosis.diagnosing import diagnosed

        evidence = self._dots.evidence(made.rig)
        if evidence is None:
            return ()
        try:
            return diagnosed(evidence).findings
        except InputError:  # no picture shows enough to judge
            return ()

    def show(self) -> None:
        """Show the calibrated rig."""
        from labcal.live.outcome import outcome_of
        from labcal.live.shown import Phase

        if self.made is None:
            return
        page = as_path(self.page.path)
        self.board.put_page(page.read_bytes())
        files = {"shoot": self.folder, "rig": self.rig, "page": page}
        outcome = outcome_of(self.made, files, self.page.phrase)
        reached = self.board.shown.reached_mm
        if reached is not None:
            over = ("Over all the space where it was held", f"a 3-D error of {reached:.2g} mm (RMS, 1 sigma)")
            outcome = replace(outcome, figures=(*outcome.figures[:1], over, *outcome.figures[1:]))
        request = "The calibration is done. Leave the cameras as they are"
        self.board.show(phase=Phase.DONE, request=request, hint="", outcome=outcome, work=None, error="")
        self.show_findings(self._findings(self.made))  # may take a while; the rig is there already

    def linger(self) -> None:
        """Serve until the page is closed, or nobody looks at it any more, or a person presses Ctrl-C."""
        from labcal.live.command import Command

        try:
            while time.monotonic() - self.board.asked_s < self._how.linger_s:
                wish = self.board.next_wish(_LOOK_S)
                if wish is not None and wish.command is Command.CLOSE:
                    return
        except KeyboardInterrupt:
            return
