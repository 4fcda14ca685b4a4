"""Shoots from cameras: real, replayed and simulated ones."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from typing import TYPE_CHECKING

from labcal.arguments import settings_of, texts
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.progress import Progress, progress_of
from labcal.targets.catalogue import AnyTarget, AnyTargets, target_of
from labcal.targets.one_kind import single_board

if TYPE_CHECKING:
    from labcal.capture.addresses import Address
    from labcal.capture.advice import Advice
    from labcal.capture.capturing import Captured, CaptureRun
    from labcal.capture.guide_settings import GuideSettings
    from labcal.capture.settings import CaptureSettings
    from labcal.capture.simulated import SimulatedCameras
    from labcal.capture.source import Source

_PLAIN = "Or capture without the guide, which takes several boards side by side."


def capture(
    sources: str | Sequence[str],
    folder: AnyPath,
    target: AnyTargets | None = None,
    settings: "CaptureSettings | None" = None,
    ask: Callable[[str], None] | None = None,
    progress: Progress | None = None,
) -> "Captured":
    """Take pictures with one camera or several, and make a shoot of them.

    Parameters
    ----------
    sources : str or sequence of str
        Addresses: ``"uvc:0"``, ``"genicam:SERIAL"``, ``"sim:SCENE"``, ``"folder:PATH"``, ``"watch:PATH"``;
        with the camera's name before, ``"left=uvc:0"``. Several are triggered together.
    folder : path
        The shoot to appear. It is whole after every view; what an interrupted run left is gone on with.
    target : str, AnyTarget or sequence of these, optional
        The target that the pictures show, which a scene and a shoot that is replayed bring with them; several
        in a list are boards side by side. Without it the code of a print tells it; where there is none, the
        shoot names no target, and motion during a set is not noticed.
    settings : CaptureSettings, optional
        How many views, how often, which sets are refused, a stage's readings, the sources' own settings, and
        those of a guided capture.
    ask : callable, optional
        Called with words before each set, of a guided capture with the advice; returns when a person has
        done what they say.
    progress : Progress, optional

    Returns
    -------
    Captured
        The shoot, and the sets that were refused.

    Raises
    ------
    DeviceError
        A camera is missing, fails or is too late; the views taken before are whole.
    InputError
        An address or a setting cannot be used.
    OutputError
        The folder exists already, or may not be made.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> shoot = examples.shoot("shoot")
    >>> pipeline.capture("folder:shoot", "again", shoot.target)
    Captured(folder=again, views=2, refused=0)
    """
    from labcal.capture.capturing import capture_shoot

    source, run = planned_capture(sources, target, settings, ask, progress)
    return capture_shoot(source, as_path(folder), run, progress_of(progress))


def planned_capture(
    sources: str | Sequence[str],
    target: AnyTargets | None,
    settings: "CaptureSettings | None",
    ask: Callable[[str], None] | None,
    progress: Progress | None = None,
) -> "tuple[Source, CaptureRun]":
    """Return the source of a capture, not opened yet, and all else that it needs; as of :func:`capture`."""
    from labcal.capture.addresses import named_addresses, source_at
    from labcal.capture.capturing import CaptureRun
    from labcal.capture.settings import CaptureSettings
    from labcal.capture.several import SeveralSources, SeveralWaiting
    from labcal.capture.simulated import SimulatedCameras
    from labcal.capture.source import Waiting
    from labcal.capture.stage import read_stage
    from labcal.capture.video import videos_together
    from labcal.targets.print_scale import as_printed

    how = settings_of(settings, CaptureSettings)
    given = [sources] if isinstance(sources, str) else list(texts(sources, "sources"))
    addresses = named_addresses(given)
    made = [source_at(address, how.source_settings) for address in addresses]
    simulated = [source for source in made if isinstance(source, SimulatedCameras)]
    if simulated and len(made) > 1:
        raise InputError("A scene has all its cameras. Give sim:SCENE alone.")
    known = simulated[0].scene.target if simulated else _replayed_target(addresses)
    shown = known if target is None else target_of(target)
    shown = None if shown is None else as_printed(shown, how.print_scale)
    readings = () if how.stage is None else read_stage(how.stage)
    command = {
        "sources": [str(one) for one in addresses],
        "cameras": [one.camera for one in addresses],
        "target": None if shown is None else shown.model_dump(mode="json"),
        "settings": {**asdict(how.source_settings), "views": how.views},
        **({} if how.guide is None else {"guide": asdict(how.guide)}),
        "stage": [one.view for one in readings],
        **({} if how.print_scale is None else {"print_scale": how.print_scale}),
    }
    receiver = progress_of(progress)
    run = CaptureRun(f"capture {json.dumps(command, sort_keys=True)}", shown, readings, how, ask)
    if how.guide is not None:
        if shown is not None:
            single_board(shown, "A guided capture takes", _PLAIN)
        run = _guided(run, how.guide, simulated[0] if simulated else None)
    if len(made) == 1:
        source: Source = made[0]
    elif all(address.kind == "video" for address in addresses):
        source = videos_together(addresses, shown, how.source_settings, receiver)
    elif all(isinstance(one, Waiting) for one in made):
        source = SeveralWaiting(made)
    else:
        source = SeveralSources(made)
    return source, run


def _replayed_target(addresses: "Sequence[Address]") -> AnyTarget | None:
    """Return the target that the shoots which are replayed name; None where they do not, or name several."""
    from labcal.shoot.dataset import MANIFEST, open_shoot

    found: list[AnyTarget | None] = []
    for address in addresses:
        if address.kind != "folder" or not (as_path(address.place) / MANIFEST).is_file():
            return None
        target = open_shoot(address.place).manifest.target
        found += [] if target in found else [target]
    return found[0] if len(found) == 1 else None


def _guided(run: "CaptureRun", guide: "GuideSettings", simulated: "SimulatedCameras | None") -> "CaptureRun":
    """Return a run with an advisor, and with a hand that follows it where the cameras are simulated."""
    from labcal.calibrate.lens_start import require_adjustable
    from labcal.guide.next_pose.guided_by_code import GuidedByCode
    from labcal.guide.next_pose.guided_capture import GuidedCapture
    from labcal.guide.next_pose.hand import parsed_hand_error
    from labcal.guide.next_pose.simulated_hand import SimulatedHand, start_of

    if run.stage:
        raise InputError(
            "A guided capture asks for poses itself, and a stage has a list of them. Leave out `stage`, or "
            "the guide."
        )
    require_adjustable(guide.lens)
    seed = run.settings.source_settings.seed
    error = parsed_hand_error(guide.hand_error)
    if run.target is None:
        return replace(run, advisor=GuidedByCode(guide, seed))
    advisor = GuidedCapture(run.target, guide, seed)
    if simulated is None:
        return replace(run, advisor=advisor)
    scene = simulated.scene
    hand = SimulatedHand(scene.true_cameras(), run.target, start_of(scene, seed), error, seed)

    def follow(advice: "Advice") -> None:
        if not advice.done:
            simulated.hold(hand.pose_for(advice))

    return replace(run, advisor=advisor, show=follow)
