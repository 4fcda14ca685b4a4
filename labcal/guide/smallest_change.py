"""The smallest change that a check would have found, as it is reported."""

from dataclasses import dataclass

import numpy as np

from labcal.calibrate.validity.change import ChangeKind
from labcal.calibrate.validity.power import Sensitivity

_REPORTED = {
    ChangeKind.TURNED: (180.0 / np.pi, "degrees"),
    ChangeKind.SHIFTED: (1.0, "mm"),
    ChangeKind.REFOCUSED: (100.0, "percent"),
}


@dataclass(frozen=True)
class SmallestChange:
    """The smallest change of one kind that is found nine times in ten, by the axis that tells least.

    Attributes
    ----------
    kind : ChangeKind
    cameras : tuple of str
    size : float
        Infinite where the pictures would not tell.
    unit : str
        ``degrees``, ``mm`` or ``percent`` of the focal length.
    """

    kind: ChangeKind
    cameras: tuple[str, ...]
    size: float
    unit: str

    @classmethod
    def of(cls, power: Sensitivity, names: tuple[str, ...]) -> "list[SmallestChange]":
        """Return it for a turn, a shift or a refocus; nothing for kinds that combine these."""
        if power.change.kind not in _REPORTED:
            return []
        factor, unit = _REPORTED[power.change.kind]
        who = tuple(names[camera] for camera in power.change.suspects)
        return [cls(power.change.kind, who, factor * float(power.smallest().max()), unit)]

    @property
    def words(self) -> str:
        """The change for people."""
        who = " or ".join(f"'{name}'" for name in self.cameras)
        unit = {"percent": "% of the focal length"}.get(self.unit, self.unit)
        return f"camera {who} {self.kind.value} by {self.size:.2g} {unit}"
