"""Names of the checks of a diagnosis."""

from enum import StrEnum


class CheckName(StrEnum):
    """A mistake that a shoot is checked for."""

    WRONG_TARGET = "wrong-target"
    MIXED_SIZES = "mixed-sizes"
    SWAPPED_CAMERAS = "swapped-cameras"
    TURNED_TARGET = "turned-target"
    UNSYNCHRONISED = "unsynchronised"
    CAMERA_MOVED = "camera-moved"
    REFOCUSED = "refocused"
    ROLLING_SHUTTER = "rolling-shutter"
    BENT_BOARD = "bent-board"
    WRONG_PITCH = "wrong-pitch"
    BLURRED = "blurred"
    EXPOSURE = "exposure"
    TOO_FEW_VIEWS = "too-few-views"
    TOO_LITTLE_TILT = "too-little-tilt"
    POOR_COVERAGE = "poor-coverage"
