"""The advisor of a guided capture whose target nobody named: it waits for the view whose code tells it."""

import numpy as np

from labcal.capture.advice import Advice, Advisor
from labcal.capture.guide_settings import GuideSettings
from labcal.capture.source import CameraInfo, FrameSet
from labcal.guide.next_pose.guided_capture import CELLS, GuidedCapture

_ASK = (
    "Show the printed code. Hold the target upright in front of the cameras, still and so near that the "
    "square code in its margin is sharp in a picture, and take a view: the code tells which target this is"
)
_UNREAD = (
    "no code of a print is read in this view: hold the code nearer and still, or begin again with the name "
    "of the target"
)


class GuidedByCode:
    """An :class:`~labcal.capture.advice.Advisor` that guides from the first view on that tells its target.

    Parameters
    ----------
    settings : GuideSettings
    seed : int
        Of the poses to choose from.
    """

    def __init__(self, settings: GuideSettings, seed: int) -> None:
        self._settings, self._seed = settings, seed
        self._cameras: tuple[CameraInfo, ...] = ()
        self._before: list[tuple[FrameSet, str]] = []
        self._guide: Advisor | None = None
        self._faults: tuple[str, ...] = ()

    def begin(self, cameras: tuple[CameraInfo, ...]) -> None:
        """Learn the cameras."""
        self._cameras = cameras

    def judge(self, taken: FrameSet, view: str) -> tuple[str, ...]:
        """Judge a set; the sets before the code was read are judged with the first one that tells it."""
        if self._guide is not None:
            return self._guide.judge(taken, view)
        self._before.append((taken, view))
        if taken.target is None:
            self._faults = (_UNREAD,)
            return self._faults
        guide = GuidedCapture(taken.target, self._settings, self._seed)
        guide.begin(self._cameras)
        for sets, name in self._before:
            self._faults = guide.judge(sets, name)
        self._guide, self._before = guide, []
        return self._faults

    def forget(self, view: str) -> None:
        """Forget a view that has left the shoot."""
        self._before = [one for one in self._before if one[1] != view]
        if self._guide is not None:
            self._guide.forget(view)

    def advise(self) -> Advice:
        """Return the advice: to show the code, until it is read."""
        if self._guide is not None:
            return self._guide.advise()
        return Advice(
            words=_ASK,
            outlines={},
            T_world_target=None,
            reached_mm=None,
            calibration_mm=None,
            wanted_mm=self._settings.wanted_mm,
            faults=self._faults,
            coverage={one.name: np.zeros(CELLS, dtype=np.int64) for one in self._cameras},
            lacks=(),
            views=0,
            done=False,
            sizes={one.name: one.size for one in self._cameras},
        )
