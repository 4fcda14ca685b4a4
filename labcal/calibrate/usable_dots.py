"""Selection of the detections that enter a calibration."""

from collections import Counter

import numpy as np

from labcal.correspond.detections import Detections
from labcal.correspond.matching import require_on_target
from labcal.errors import InputError
from labcal.targets.target import Target
from labcal.wording import counted

MIN_DOTS = 8
"""Dots that a view needs to enter: a homography takes four, and a lens wants more than it leaves over."""


def usable_dots(detections: Detections, target: Target) -> Detections:
    """Return the dots that are measurements.

    Raises
    ------
    InputError
        There is none, one is not on the target, has no position, or is listed twice.
    """
    usable = detections.measured()
    if len(usable) == 0:
        raise InputError("There are no dots with ids to calibrate with. See the flags in the detections.")
    require_on_target(usable, target)
    return usable


def unmeasured_pictures(detections: Detections) -> tuple[str, ...]:
    """Return which pictures have no dot that is a measurement, and what their dots are, for people."""
    pictures = np.stack([detections.camera_number, detections.view_number], axis=1)
    measured = {tuple(picture) for picture in pictures[detections.ok].tolist()}
    flags: dict[tuple[int, int], Counter[str]] = {}
    for picture, flag in zip(map(tuple, pictures.tolist()), detections.flag.tolist(), strict=True):
        if picture not in measured:
            flags.setdefault(picture, Counter())[flag] += 1
    return tuple(
        f"view '{detections.views[view]}' of camera '{detections.cameras[camera]}': none of its dots is "
        f"measured ({', '.join(f'{count} {flag}' for flag, count in sorted(found.items()))})"
        for (camera, view), found in flags.items()
    )


def in_full_pictures(usable: Detections) -> tuple[Detections, tuple[str, ...]]:
    """Return the dots of pictures with enough of them; and what does not enter, for people."""
    picture = usable.camera_number * len(usable.views) + usable.view_number
    dots = np.bincount(picture, minlength=len(usable.cameras) * len(usable.views))
    skipped = []
    for few in np.flatnonzero((dots > 0) & (dots < MIN_DOTS)):
        camera, view = divmod(int(few), len(usable.views))
        what = f"view '{usable.views[view]}' of camera '{usable.cameras[camera]}'"
        skipped.append(f"{what}: only {counted(int(dots[few]), 'dot')}, at least {MIN_DOTS} are needed")
    return usable.where(dots[picture] >= MIN_DOTS), tuple(skipped)
