"""Advice of a guided capture: what the pictures so far lack, and the pose to take next."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, Int

from labcal.arrays import Pose
from labcal.capture.source import CameraInfo, FrameSet


@dataclass(frozen=True)
class Advice:
    """The next step, and the state of the shoot so far."""

    words: str
    """The next pose in words, or why the capture is done."""
    outlines: Mapping[str, Float[np.ndarray, "corner 2"]]
    """By camera: the outline that the target's dots are to fill, px, a closed polygon; a camera that is not
    to see the target has none."""
    T_world_target: Pose | None
    """Pose that is asked for, mm, in the frame of the calibration so far (its first camera's); None before
    there is one."""
    reached_mm: float | None
    """Expected 3-D error over the volume, in the frame of the first camera, after the views so far: root mean
    square of the distance, mm, by the calibration and by the noise of the point's own pixels; None before
    there is a calibration of enough views."""
    calibration_mm: float | None
    """The calibration's share of it, mm."""
    wanted_mm: float | None
    """The error that was asked for, mm, to compare `reached_mm` with; None where none was."""
    faults: tuple[str, ...]
    """Of the last set, for people: blur, exposure, a pose taken before, a target not found and why."""
    coverage: Mapping[str, Int[np.ndarray, "row column"]]
    """By camera: dots found so far in each cell of a coarse grid over the picture."""
    lacks: tuple[str, ...]
    """Gaps of the views so far, for people: parts of a picture, tilts, distances."""
    views: int
    """Number of usable views so far."""
    done: bool
    """True where the error asked for is reached."""
    sizes: Mapping[str, tuple[int, int]]
    """Width and height of the pictures by camera, px."""
    shape_mm: float | None = None
    """`reached_mm` after a rigid alignment of the points: the error of their shape and size, which no frame
    of coordinates is part of; None of one camera, and before there is `reached_mm`."""


@runtime_checkable  # so that tests can check annotations
class Advisor(Protocol):
    """Looks at each set of pictures, and says what to take next."""

    def begin(self, cameras: tuple[CameraInfo, ...]) -> None:
        """Learn which cameras there are; called once, before anything else."""

    def judge(self, taken: FrameSet, view: str) -> tuple[str, ...]:
        """Look at a set that entered the shoot.

        Returns
        -------
        tuple of str
            Its faults, for people; empty for a good one.
        """

    def forget(self, view: str) -> None:
        """Forget a view that has left the shoot."""

    def advise(self) -> Advice:
        """Return the advice after the sets judged so far."""
