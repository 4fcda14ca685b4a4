"""The capture of a shoot: sets of pictures are taken, judged, and written one after another."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from labcal.capture.advice import Advice, Advisor
from labcal.capture.advice_text import advice_text
from labcal.capture.attendant import Attendant, DropView
from labcal.capture.guide_settings import MOST_VIEWS
from labcal.capture.recorder import Recorder
from labcal.capture.settings import CaptureSettings
from labcal.capture.source import FrameSet, Source, opened
from labcal.capture.stage import StageView
from labcal.capture.target_motion import MOST_PX, motion_px
from labcal.errors import DeviceError, InputError
from labcal.public_object import PublicObject
from labcal.run.growing import growing_folder
from labcal.run.progress import Progress
from labcal.shoot.dataset import Shoot, open_shoot
from labcal.targets.catalogue import AnyTarget
from labcal.wording import counted

LIVE_VIEWS = 20
"""Views of live cameras where no number is given."""


@dataclass(frozen=True)
class RefusedSet:
    """Pictures that did not enter the shoot."""

    number: int
    """Number of the set in this run, from 1."""
    view: str | None
    """Name of the view, where the source has one."""
    reasons: tuple[str, ...]
    """Each names its camera or device."""


@dataclass(frozen=True, eq=False, repr=False)
class Captured(PublicObject):
    """A captured shoot, and what did not enter it."""

    shoot: Shoot
    """The shoot."""
    refused: tuple[RefusedSet, ...]
    """Sets that were refused; of live cameras they were taken again."""
    notes: tuple[str, ...]
    """Settings that the devices refused, and where the target is read, for people."""
    replayed: bool
    """True if the sets came from a recording, of which a refused one is lost."""
    advice: Advice | None = None
    """The last advice of a guided capture; None of others."""

    def _summary(self) -> Mapping[str, object]:
        return {
            "folder": self.shoot.folder.as_posix(),
            "views": len(self.shoot.views()),
            "refused": len(self.refused),
        }


@dataclass(frozen=True)
class CaptureRun:
    """All that a capture needs besides its source and its folder."""

    command: str
    """Everything that determines the shoot, as text."""
    target: AnyTarget | None
    """Target that the pictures show; None where the code of its print is to tell it. Until it is read, and
    where there is none, motion is not judged."""
    stage: tuple[StageView, ...]
    """Readings of a stage in the order of the views; empty for a target in the hand."""
    settings: CaptureSettings
    ask: Callable[[str], None] | None
    """Called before each set with what is to be done; returns when a person has done it."""
    advisor: Advisor | None = None
    """Judges each set that entered, and ends the capture when it says that it is done; None where nobody
    guides."""
    show: Callable[[Advice], None] | None = None
    """Called with each advice before its set is taken, and with the one that says that it is done."""
    attendant: Attendant | None = None
    """Says when each set is taken and when there are enough, in place of `ask` and the clock, and has sets
    judged itself; None where nobody watches. A refused set is its matter: none ends the capture."""


def capture_shoot(source: Source, folder: Path, run: CaptureRun, progress: Progress) -> Captured:
    """Take views until there are enough, or the source has no more.

    The folder appears with the first view, and is a whole shoot after every one: what was taken before a
    device failed, or the program was killed, stays, and the same call goes on with it.

    Parameters
    ----------
    source : Source
        Not opened yet.
    folder : Path
        The shoot to appear.
    run : CaptureRun
    progress : Progress
        Notified of every view.

    Returns
    -------
    Captured

    Raises
    ------
    DeviceError
        A device failed, or so many sets in a row were refused as `settings.tries` says; the message names
        the device and tells how many views are in the shoot.
    InputError
        The source gives no picture at all.
    OutputError
        The folder exists already, or the disk refuses.
    """
    with opened(source) as cameras, growing_folder(folder, run.command, force=run.settings.force) as growing:
        infos = cameras.describe()
        recorder = Recorder(growing, run.target, infos, run.settings.print_scale)
        cameras.skip((*recorder.views, *recorder.dropped))
        if run.advisor is not None:
            run.advisor.begin(infos)
            for view, before in recorder.recorded():
                run.advisor.judge(before, view)
        try:
            refused = _take_views(cameras, recorder, run, progress)
        except DeviceError as error:
            done = len(recorder.views)
            kept = f"{counted(done, 'view')} taken before {'is' if done == 1 else 'are'} in {folder}."
            raise DeviceError(f"{error} {kept if done else 'No view was taken before.'}") from error
        if not recorder.views:
            raise InputError(_nothing(refused, recorder.dropped))
    notes = (*(note for one in infos for note in one.notes), *recorder.target_notes)
    if recorder.target is None and run.settings.print_scale is not None:
        notes += ("`print_scale` is not stored: no target is named, and no code of a print is read",)
    advice = None if run.advisor is None else run.advisor.advise()
    return Captured(open_shoot(folder), tuple(refused), notes, not source.live, advice)


def _take_views(source: Source, recorder: Recorder, run: CaptureRun, progress: Progress) -> list[RefusedSet]:
    """Take the views that are missing, and return the sets that were refused."""
    settings, refused, in_a_row = run.settings, list[RefusedSet](), 0
    wanted, by_clock = _wanted(source, run), source.live and run.attendant is None and run.ask is None
    progress.start("capture", wanted or 0, len(recorder.views))
    number, due = 0, time.monotonic()
    while wanted is None or len(recorder.views) < wanted:
        if not _is_to_be_taken(recorder, run, wanted):
            break
        view = _next_view(recorder, run)
        if by_clock:
            time.sleep(max(0.0, due - time.monotonic()))
            due = time.monotonic() + settings.interval_s
        taken = source.trigger()
        if taken is None:
            break
        number += 1
        reasons = _reasons(taken, source, recorder, run)
        if reasons:
            refused.append(RefusedSet(number, taken.view, reasons))
            in_a_row += 1
            _tell(run, taken, None, reasons)
            if source.live and run.attendant is None and in_a_row == settings.tries:
                raise DeviceError(f"{counted(in_a_row, 'set')} in a row were refused. {'; '.join(reasons)}.")
            continue
        in_a_row = 0
        placed = recorder.with_target(_placed(taken, view))
        name = recorder.free_name(placed.view)
        recorder.add(placed, name)
        _tell(run, placed, name, ())
        progress.advance()
    return refused


def _wanted(source: Source, run: CaptureRun) -> int | None:
    """Return the number of views to take; None for all that there are, or as many as the attendant wants."""
    given = run.settings.views or len(run.stage) or None
    if given is not None or run.attendant is not None:
        return given
    if run.advisor is not None:
        return MOST_VIEWS
    return LIVE_VIEWS if source.live else None


def _is_to_be_taken(recorder: Recorder, run: CaptureRun, wanted: int | None) -> bool:
    """Ask for the next set, and return when it is to be taken; False where no more is."""
    if run.attendant is not None:
        return _attended(run.attendant, recorder, run, wanted)
    view, done = _next_view(recorder, run), len(recorder.views)
    advice = None if run.advisor is None else run.advisor.advise()
    if advice is not None and run.show is not None:
        run.show(advice)
    if advice is not None and advice.done:
        return False
    if run.ask is not None:
        run.ask(_request(view, done, wanted) if advice is None else advice_text(advice))
    return True


def _attended(attendant: Attendant, recorder: Recorder, run: CaptureRun, wanted: int | None) -> bool:
    """Return what the attendant says of the next set, after the views that it has dropped before."""
    while True:
        request = _request(_next_view(recorder, run), len(recorder.views), wanted)
        answer = attendant.wait(request, recorder.views)
        if not isinstance(answer, DropView):
            return answer
        if answer.view in recorder.views:
            recorder.drop(answer.view)
            attendant.dropped(answer.view)


def _tell(run: CaptureRun, taken: FrameSet, view: str | None, reasons: tuple[str, ...]) -> None:
    """Tell who stands beside what became of a set: its name in the shoot, or why it was refused."""
    if run.attendant is not None:
        run.attendant.heard(taken, view, reasons)
    elif run.advisor is not None and view is not None:
        run.advisor.judge(taken, view)


def _reasons(taken: FrameSet, source: Source, recorder: Recorder, run: CaptureRun) -> tuple[str, ...]:
    """Return why a set may not enter the shoot."""
    reasons = list(taken.refusals)
    unfit = recorder.refusal(taken)
    if unfit is not None and not reasons:
        reasons.append(unfit)
    skew = taken.skew_s
    if skew is not None and 1e3 * skew > run.settings.max_skew_ms:
        times = {name: frame.time_s for name, frame in taken.frames.items() if frame.time_s is not None}
        late = max(times, key=lambda name: times[name])
        reasons.append(
            f"the picture of camera {late} was taken {1e3 * skew:.0f} ms after the first one, more than "
            f"{run.settings.max_skew_ms:g} ms: trigger the cameras together"
        )
    if not reasons and recorder.target is not None:
        after = source.follow()
        moved = {} if after is None else motion_px(taken, after, recorder.target)
        reasons += [
            f"the target moved by {px:.2f} px in the picture of camera {name} while it was taken: hold it "
            "still, shorten the exposure, or trigger the cameras together"
            for name, px in moved.items()
            if px > MOST_PX
        ]
    return tuple(reasons)


def _next_view(recorder: Recorder, run: CaptureRun) -> StageView | None:
    """Return the reading of the stage that comes next."""
    return next((one for one in run.stage if one.view not in recorder.views), None)


def _placed(taken: FrameSet, view: StageView | None) -> FrameSet:
    """Return a set with the pose and the name that a stage's reading gives it."""
    if view is None:
        return taken
    return FrameSet(taken.frames, view.view, view.T_world_target, view.role)


def _request(view: StageView | None, done: int, wanted: int | None) -> str:
    """Return what a person is to do before the next set."""
    of = "" if wanted is None else f" of {wanted}"
    if view is None:
        return f"View {done + 1}{of}: hold the target still"
    x, y, z = view.T_world_target[:3, 3]
    return f"View {done + 1}{of}, '{view.view}': move the stage to {x:g}, {y:g}, {z:g} mm"


def _nothing(refused: list[RefusedSet], dropped: tuple[str, ...]) -> str:
    if dropped:
        return "Every view was taken out of the shoot again, so that there is none. Take more."
    if not refused:
        return "The source gives no picture. See that it holds what is wanted."
    return f"Every set of pictures was refused: {'; '.join(refused[0].reasons)}."
