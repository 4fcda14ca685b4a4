"""The picture of a moving target as a weighted mean of still ones: their times and weights by row."""

from dataclasses import dataclass

import numpy as np

from labcal.cameras.dot_image import flat_outlines
from labcal.errors import InputError
from labcal.scene.motion import ShutterTimes
from labcal.scene.take import Take
from labcal.targets.target import PrintableTarget

LARGEST_STEP_PX = 0.1
"""No part of a dot's outline moves by more from one sub-frame to the next."""
MOST = 1000
INSTANTS = 9
"""Times within the exposure at which the speed in the picture is looked at; the middle is one of them."""
SMALL_TURN = 1e-3
"""The speed is taken over a turn of no more radians, since a chord is shorter than its arc."""
SMALL_MOVE_MM = 0.1
"""And over a way that is no longer, since what is fast soon leaves the picture."""
EVERY = 8
"""Of the points of an outline, one in so many is looked at."""
NEGLIGIBLE = 1e-9
"""Weights below are rounding."""


@dataclass(frozen=True)
class Subframes:
    """Still pictures whose weighted sum is the picture of a moving target."""

    seconds: np.ndarray
    """(n,), when each is taken, from the middle of the frame."""
    weights: np.ndarray
    """(n, rows), the share of each in a row; the shares of a row sum to 1."""

    @property
    def averaged(self) -> float:
        """The number of equally weighted sub-frames with the same noise as the row with the highest noise."""
        return float(1.0 / (self.weights**2).sum(axis=0).max())

    def rows(self, number: int) -> tuple[int, int]:
        """Return the first row in which a sub-frame has a weight, and the one after the last."""
        (shared,) = np.nonzero(self.weights[number])
        return int(shared[0]), int(shared[-1]) + 1


def subframes(take: Take, target: PrintableTarget) -> Subframes:
    """Return the sub-frames of a picture, each at most 0.1 px from the next.

    A row's average is the integral over its exposure of what is interpolated between the sub-frames. So the
    mean time of a row is the middle of its exposure exactly, however few there are.

    Parameters
    ----------
    take : Take
    target : PrintableTarget
        The target as it is printed.

    Raises
    ------
    InputError
        The target moves so fast that there would be more than 1000.
    """
    span = take.shutter.span_s
    path = 0.0 if take.track.stands_still or span == 0.0 else span * _speed(take, target)
    steps = int(np.ceil(path / LARGEST_STEP_PX))
    if steps >= MOST:
        raise InputError(
            f"In view '{take.view}' the target moves by {path:.0f} px in the picture of camera "
            f"'{take.taken_by}' while that is taken ({1e3 * span:g} ms); more than {MOST} sub-frames of "
            f"{LARGEST_STEP_PX:g} px are not rendered. Lessen motion.velocity_mm_s, motion.rotation_deg_s, "
            "readout_ms or the exposure time."
        )
    if steps == 0:
        return Subframes(np.zeros(1), np.ones((1, take.shutter.rows)))
    seconds = np.linspace(-0.5 * span, 0.5 * span, steps + 1)
    weights = _weights(seconds, take.shutter)
    shared = weights.any(axis=1)  # with a fast movement, some fall between two rows
    return Subframes(seconds[shared], weights[shared])


def _speed(take: Take, target: PrintableTarget) -> float:
    """Return the highest speed of a dot outline in the picture, px/s; 0 if it shows none."""
    outlines = flat_outlines(target.points(), 0.5 * target.outer_diameters_mm())[:, ::EVERY].reshape(-1, 3)
    span = take.shutter.span_s
    turning, moving = (float(np.linalg.norm(v)) for v in (take.track.rotation, take.track.velocity))
    short = 1.0 / max(INSTANTS / span, turning / SMALL_TURN, moving / SMALL_MOVE_MM)
    fastest = 0.0
    for instant in np.linspace(-0.5 * span, 0.5 * span, INSTANTS):
        before, after = (
            take.device.project(take.track.carried(outlines, np.full(len(outlines), seconds))).q
            for seconds in (instant - 0.5 * short, instant + 0.5 * short)
        )
        shown = take.device.in_picture(before) | take.device.in_picture(after)
        steps = np.linalg.norm(after - before, axis=-1)[shown]
        fastest = max(fastest, float(steps.max(initial=0.0, where=np.isfinite(steps))) / short)
    return fastest


def _weights(seconds: np.ndarray, shutter: ShutterTimes) -> np.ndarray:
    """Return the weights of each sub-frame by row: its hat function, averaged over the exposure."""
    step = seconds[1] - seconds[0]
    middle = (shutter.middles(np.arange(shutter.rows)) - seconds[:, None]) / step
    half = 0.5 * shutter.exposure_s / step
    if half > 0.0:
        weights = (_hat_integral(middle + half) - _hat_integral(middle - half)) / (2.0 * half)
    else:
        weights = np.clip(1.0 - np.abs(middle), 0.0, None)
    weights[weights < NEGLIGIBLE] = 0.0
    return np.asarray(weights / weights.sum(axis=0))


def _hat_integral(x: np.ndarray) -> np.ndarray:
    """Return the integral from the left of a hat function of height 1 from -1 to 1."""
    inside = np.clip(x, -1.0, 1.0)
    return np.asarray(np.where(inside < 0.0, 0.5 * (1.0 + inside) ** 2, 1.0 - 0.5 * (1.0 - inside) ** 2))
