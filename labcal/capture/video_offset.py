"""Offset in time between two videos, from the motion of the target in both."""

from itertools import islice

import numpy as np
from jaxtyping import Float64

from labcal.capture.video_file import VideoFile
from labcal.detect.detector import detect_dots
from labcal.errors import InputError
from labcal.geometry.epipolar import epipolar_misfit
from labcal.run.progress import NoProgress, Progress
from labcal.targets.catalogue import AnyTarget

LOOKED_AT_S = 10.0
"""Length of the videos that is looked at, from their beginning, s."""
MOST_FRAMES = 300
"""No more frames of a video are looked at."""
LONGEST_S = 3.0
"""Longest offset that is sought, s."""
LEAST_FRAMES = 10
"""Frames with the target in both videos that an offset needs."""
_COARSE, _FINE = 0.5, 0.05  # frames
_LEAST_PX = 0.02
"""Distances below it are noise of the dots."""
_LEAST_GAIN = 2.0
"""The best offset must leave less than typical ones by this factor, in mean square."""

Tracks = Float64[np.ndarray, "frames dots 2"]
"""Pixels of every dot of the target by frame; NaN where it was not measured."""


def offset_frames(
    first: VideoFile, other: VideoFile, target: AnyTarget, progress: Progress | None = None
) -> float:
    """Return how many frames of the other video a moment comes later in it than in the first one.

    At the right offset the pixels of the dots in both videos obey one epipolar geometry, whatever the motion:
    that of the two cameras. The offset is the one that leaves the least distance to it
    (:func:`~labcal.geometry.epipolar.epipolar_misfit`); the other video is interpolated between its frames,
    so that the offset is found to fractions of one.

    Parameters
    ----------
    first, other : VideoFile
    target : AnyTarget
        The target that both see.
    progress : Progress, optional
        Of the frames that are looked at.

    Raises
    ------
    InputError
        The target is seen too seldom in both at once, or does not move enough to tell.
    """
    report = progress or NoProgress()
    report.start(f"time offset of {other.path.name}", _looked_at(first) + _looked_at(other))
    ours, theirs = (_tracks(video, target, report) for video in (first, other))
    ratio = other.rate / first.rate
    reach = LONGEST_S * other.rate
    lags = np.arange(-reach, reach + _COARSE, _COARSE)
    left = np.array([_left_over(ours, theirs, ratio, lag) for lag in lags])
    if not np.isfinite(left).any():
        raise InputError(
            f"The target is seen in {first.path} and {other.path} at once in too few frames to tell "
            "their offset. Name it: `video_offset=FRAMES`."
        )
    best = float(lags[int(np.nanargmin(left))])
    if not float(np.nanmedian(left)) >= _LEAST_GAIN * max(float(np.nanmin(left)), _LEAST_PX**2):
        raise InputError(
            f"The target moves too little in {first.path} and {other.path} to tell their offset. Begin with "
            "some quick motions of the target, or name the offset: `video_offset=FRAMES`."
        )
    near = np.arange(best - _COARSE, best + _COARSE + _FINE, _FINE)
    return float(near[int(np.nanargmin([_left_over(ours, theirs, ratio, lag) for lag in near]))])


def _wanted(video: VideoFile) -> int:
    """Return the number of frames that are looked at, if the video has them."""
    return min(MOST_FRAMES, int(LOOKED_AT_S * video.rate))


def _looked_at(video: VideoFile) -> int:
    """Return how many of these the video has by its header."""
    return min(_wanted(video), video.stated_frames or MOST_FRAMES)


def _tracks(video: VideoFile, target: AnyTarget, progress: Progress) -> Tracks:
    """Return the dots of the first frames."""
    promised = _looked_at(video)
    tracks = []
    for picture in islice(video.frames(), _wanted(video)):
        dots = detect_dots(picture, target)
        col, row = dots.index.T
        known = dots.has_id & (col >= 0) & (col < target.cols) & (row >= 0) & (row < target.rows)
        found = np.full((target.count, 2), np.nan)
        found[row[known] * target.cols + col[known]] = dots.position[known]
        tracks.append(found)
        progress.advance(1 if len(tracks) <= promised else 0)
    progress.advance(max(0, promised - len(tracks)))
    return np.array(tracks)


def _left_over(first: Tracks, other: Tracks, ratio: float, lag: float) -> float:
    """Return the mean square distance to epipolar lines at an offset, px squared.

    NaN where less than half of the frames with the target overlap: a short piece of a motion fits any other.
    """
    at = np.arange(len(first)) * ratio + lag
    below = np.floor(at).astype(int)
    inside = (below >= 0) & (below + 1 < len(other))
    part = np.clip(below, 0, len(other) - 2)
    share = (at - part)[:, None, None]
    moved = (1.0 - share) * other[part] + share * other[part + 1]
    known = inside[:, None] & np.isfinite(first).all(axis=2) & np.isfinite(moved).all(axis=2)
    seen = min(int(np.isfinite(one).any(axis=(1, 2)).sum()) for one in (first, other))
    if known.any(axis=1).sum() < max(LEAST_FRAMES, 0.5 * seen):
        return float("nan")
    return epipolar_misfit(first[known], moved[known]) ** 2
