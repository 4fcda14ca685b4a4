"""The result of a capture on the live page."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from labcal.calibrate.calibration import Calibration
from labcal.capture.capturing import Captured
from labcal.public_object import PublicObject


@dataclass(frozen=True, eq=False, repr=False)
class CapturedLive(PublicObject):
    """A shoot that was captured on the live page, and the rig that was calibrated from it."""

    captured: Captured
    """The shoot, and the sets that were refused."""
    calibration: Calibration
    """The calibration from its views."""
    rig: Path
    """The file of the rig."""
    page: Path
    """The page of the calibration."""

    def _summary(self) -> Mapping[str, object]:
        shoot = self.captured.shoot
        return {"folder": shoot.folder.as_posix(), "views": len(shoot.views()), "rig": self.rig.as_posix()}
