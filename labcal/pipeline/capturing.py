"""Shoots from cameras: real, replayed and simulated ones."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

from labcal.arguments import settings_of, texts
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.progress import Progress, progress_of
from labcal.targets.catalogue import AnyTarget, target_of

if TYPE_CHECKING:
    from labcal.capture.capturing import Captured
    from labcal.capture.settings import CaptureSettings
    from labcal.capture.source import Source


def capture(
    sources: str | Sequence[str],
    folder: AnyPath,
    target: AnyTarget | AnyPath | None = None,
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
    target : str or AnyTarget, optional
        The target that the pictures show, which a scene brings with it. Without it the shoot names none, and
        motion during a set is not noticed.
    settings : CaptureSettings, optional
        How many views, how often, which sets are refused, a stage's readings, and the sources' own settings.
    ask : callable, optional
        Called with words before each set; returns when a person has done what they say.
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
    from labcal.capture.addresses import named_addresses, source_at
    from labcal.capture.capturing import CaptureRun, capture_shoot
    from labcal.capture.settings import CaptureSettings
    from labcal.capture.several import SeveralSources
    from labcal.capture.simulated import SimulatedCameras
    from labcal.capture.stage import read_stage
    from labcal.capture.video import videos_together

    how = settings_of(settings, CaptureSettings)
    given = [sources] if isinstance(sources, str) else list(texts(sources, "sources"))
    addresses = named_addresses(given)
    made = [source_at(address, how.source_settings) for address in addresses]
    simulated = [source for source in made if isinstance(source, SimulatedCameras)]
    if simulated and len(made) > 1:
        raise InputError("A scene has all its cameras. Give sim:SCENE alone.")
    shown = target_of(target) if target is not None else simulated[0].scene.target if simulated else None
    readings = () if how.stage is None else read_stage(how.stage)
    command = {
        "sources": [str(one) for one in addresses],
        "cameras": [one.camera for one in addresses],
        "target": None if shown is None else shown.model_dump(mode="json"),
        "settings": {**asdict(how.source_settings), "views": how.views},
        "stage": [one.view for one in readings],
    }
    receiver = progress_of(progress)
    run = CaptureRun(f"capture {json.dumps(command, sort_keys=True)}", shown, readings, how, ask)
    if len(made) == 1:
        source: Source = made[0]
    elif all(address.kind == "video" for address in addresses):
        source = videos_together(addresses, shown, how.source_settings, receiver)
    else:
        source = SeveralSources(made)
    return capture_shoot(source, as_path(folder), run, receiver)
