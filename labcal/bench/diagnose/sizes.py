"""Sizes of mistakes: the smallest about at what harms 3-D by 20%, and larger ones."""

from collections.abc import Mapping

from labcal.guide.diagnosis.check_name import CheckName

LEVELS = 3
TIMES = (1.0, 2.0, 5.0)
"""Sizes of the levels, in units of the smallest."""
_SMALLEST: Mapping[CheckName, Mapping[str, float]] = {
    CheckName.UNSYNCHRONISED: {"wide": 0.28, "narrow": 0.032, "webcam": 0.17},
    CheckName.CAMERA_MOVED: {"wide": 0.03, "narrow": 0.0036, "webcam": 0.018},
    CheckName.REFOCUSED: {"wide": 0.00035, "narrow": 0.00019, "webcam": 0.00042},
    CheckName.BENT_BOARD: {"wide": 0.23, "narrow": 0.041, "webcam": 0.35},
    CheckName.WRONG_PITCH: {"wide": 0.00096, "narrow": 0.00038, "webcam": 0.00175},
    CheckName.ROLLING_SHUTTER: {"wide": 1.8, "narrow": 0.185, "webcam": 0.62},
}
"""About the sizes at which the RMS 3-D error grows by 20%, in the units of the mistake: first guesses.

Of the very shoot :func:`~labcal.bench.diagnose.harmful_size.harmful_size` finds them.
"""
_STEPS: Mapping[CheckName, tuple[float, float, float]] = {
    CheckName.SWAPPED_CAMERAS: (0.05, 0.25, 0.45),
    CheckName.TURNED_TARGET: (0.05, 0.25, 0.45),
    CheckName.MIXED_SIZES: (0.8, 0.5, 0.25),
    CheckName.TOO_FEW_VIEWS: (3, 2, 1),
    CheckName.BLURRED: (1.6, 2.5, 4.0),
    CheckName.EXPOSURE: (-1.7, 1.0, -4.0),
    CheckName.WRONG_TARGET: (1, 2, 3),
}
"""Mistakes of which any size spoils the calibration, or whose sizes do not depend on the rig."""
_HANDS: Mapping[CheckName, Mapping[str, tuple[float, float, float]]] = {
    CheckName.TOO_LITTLE_TILT: {
        "wide": (0.05, 0.03, 0.01), "narrow": (0.08, 0.05, 0.02), "webcam": (0.03, 0.02, 0.01),
    },
    CheckName.POOR_COVERAGE: {"wide": (0.4, 0.3, 0.1), "webcam": (0.25, 0.15, 0.08)},
}  # fmt: skip
"""Shares of the tilts and places of a good shoot."""


def size_of(check: CheckName, kind: str, level: int) -> float:
    """Return the size of a mistake.

    Parameters
    ----------
    check : CheckName
    kind : str
        Of the pair of cameras.
    level : int
        0 for the smallest one.
    """
    if check in _SMALLEST:
        return TIMES[level] * _SMALLEST[check][kind]
    return _HANDS[check][kind][level] if check in _HANDS else _STEPS[check][level]
