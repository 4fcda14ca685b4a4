"""A change of a rig as it is reported: which camera, of what kind, by how much."""

from dataclasses import dataclass

import numpy as np

from labcal.calibrate.validity.change import ChangeKind, Element
from labcal.calibrate.validity.explanation import Explanation

_FACTOR = {
    Element.TURN: 180.0 / np.pi,
    Element.SHIFT: 1.0,
    Element.FOCUS: 100.0,
    Element.PRINCIPAL_POINT: 1.0,
}
_UNIT = {
    Element.TURN: "degrees",
    Element.SHIFT: "mm",
    Element.FOCUS: "% of its focal length",
    Element.PRINCIPAL_POINT: "px of its principal point",
}


@dataclass(frozen=True)
class Amount:
    """One part of a change of one camera.

    Attributes
    ----------
    camera : str
    element : str
        ``turn`` (degrees, about the camera's axes), ``shift`` (mm, along them), ``focus`` (% of the focal
        length) or ``principal point`` (px).
    value, sigma : tuple of float
        Along each axis, with standard deviations from noise and calibration.
    """

    camera: str
    element: str
    value: tuple[float, ...]
    sigma: tuple[float, ...]

    @property
    def size(self) -> float:
        """The length of the vector; of the focus with its sign."""
        return self.value[0] if len(self.value) == 1 else float(np.linalg.norm(self.value))

    @property
    def size_sigma(self) -> float:
        """The standard deviation of the length, without correlations between the axes."""
        value, sigma = np.array(self.value), np.array(self.sigma)
        length = float(np.linalg.norm(value))
        return float(np.linalg.norm(value * sigma)) / length if length > 0.0 else float(sigma.max())

    @property
    def words(self) -> str:
        """The amount for people, as in ``0.052 +- 0.001 degrees``."""
        sign = "+" if self.element == Element.FOCUS.value else ""
        return f"{self.size:{sign}.3g} +- {self.size_sigma:.1g} {_UNIT[Element(self.element)]}"


@dataclass(frozen=True)
class FoundChange:
    """One explanation of new pictures by a change.

    Attributes
    ----------
    kind : ChangeKind
    cameras : tuple of str
        Those of which each could be the one; of ``several``, all of them.
    probability : float
        That this is the change, given that there is one.
    p_value : float
        Probability that errors alone let it explain so much, not corrected for the number of changes.
    amounts : tuple of Amount
    """

    kind: ChangeKind
    cameras: tuple[str, ...]
    probability: float
    p_value: float
    amounts: tuple[Amount, ...]

    @classmethod
    def of(
        cls, found: Explanation, probability: float, p_value: float, names: tuple[str, ...]
    ) -> "FoundChange":
        """Return the report of an explanation by a change.

        Parameters
        ----------
        found : Explanation
        probability, p_value : float
        names : tuple of str
            Of the rig's cameras.

        Raises
        ------
        TypeError
            The explanation is that of no change.
        """
        if found.change is None:
            raise TypeError("This explanation is that of no change.")
        sigma = np.sqrt(np.maximum(np.diagonal(found.size_covariance), 0.0))
        amounts = []
        for camera, element, at in found.change.parts():
            factor = _FACTOR[element]
            value, error = factor * found.size[at], factor * sigma[at]
            amounts.append(Amount(names[camera], element.value, tuple(value.tolist()), tuple(error.tolist())))
        suspects = tuple(names[camera] for camera in found.change.suspects)
        return cls(found.change.kind, suspects, probability, p_value, tuple(amounts))

    @property
    def words(self) -> str:
        """The change for people."""
        if self.kind is ChangeKind.SEVERAL:
            return f"several cameras ({', '.join(self.cameras)}) changed"
        sizes = ", ".join(one.words for one in self.amounts if one.element != Element.PRINCIPAL_POINT.value)
        if self.kind is ChangeKind.TOGETHER:
            return (
                f"all cameras were moved together, as one body: {sizes}; relative to each other they are as "
                "calibrated"
            )
        who = " or ".join(f"'{name}'" for name in self.cameras)
        which = ", it cannot be determined which," if len(self.cameras) > 1 else ""
        return f"camera {who}{which} {_VERBS[self.kind]}: {sizes}"


_VERBS = {
    ChangeKind.TURNED: "was turned about its centre of projection",
    ChangeKind.SHIFTED: "was shifted",
    ChangeKind.MOVED: "was moved",
    ChangeKind.REFOCUSED: "was refocused",
    ChangeKind.MOVED_AND_REFOCUSED: "was moved and refocused",
}
