"""Settings of a comparison of two calibrations."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite

import numpy as np

from labcal.arguments import choice_of, one_text, set_checked, wrong_type
from labcal.arrays import AnyArray, float_array
from labcal.bounds import MOST_MM
from labcal.errors import InputError
from labcal.wording import clipped, printable


class Pictures(StrEnum):
    """The origin of two calibrations: the same pictures, or different ones."""

    DIFFERENT = "different"
    """Their errors are independent."""
    SAME = "same"
    """All of them, or some: their differences are smaller than two budgets tell, so that no test is made."""


@dataclass(frozen=True)
class CompareSettings:
    """Names, distances, and the origin of the calibrations that are compared.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples
    >>> from labcal.pipeline import CompareSettings
    >>> settings = CompareSettings(distances_mm=(500.0, 700.0), pictures="different")
    >>> labcal.compare(examples.rig(), examples.rig(), settings).volume.remaining.largest < 1e-6
    True
    """

    cameras: Mapping[str, str] | None = None
    """Names of cameras in the second rig by those in the first, where they differ."""
    distances_mm: AnyArray = ()
    """Distances from the cameras, mm, at which lenses are compared; those of the target during the first
    calibration if left out. Where no rig states where its target was, they give the volume, too."""
    pictures: Pictures | str | None = None
    """``different`` or ``same``; if left out, different where no name of a view is common to both."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError, UnknownNameError
            Names are no mapping, a distance is not positive, or there is no such origin of pictures.
        """
        if not isinstance(self.cameras, Mapping | None):
            raise wrong_type(self.cameras, "a mapping of names to names", "cameras")
        names = {one_text(a, "cameras"): one_text(b, "cameras") for a, b in (self.cameras or {}).items()}
        distances = float_array(np.atleast_1d(self.distances_mm), ("n",), "distances_mm")
        for distance in distances.tolist():
            if not (isfinite(distance) and 0.0 < distance <= MOST_MM):
                raise InputError(
                    f"`distances_mm` are positive numbers up to {MOST_MM:g} mm, but {distance:g} was given."
                )
        pictures = None if self.pictures is None else choice_of(self.pictures, Pictures, "pictures")
        values = {"cameras": names, "distances_mm": tuple(distances.tolist()), "pictures": pictures}
        set_checked(self, values)

    @property
    def reach_mm(self) -> tuple[float, ...]:
        """The distances, the nearest first; none where they are left out."""
        return tuple(sorted(set(float_array(self.distances_mm, ("n",), "distances_mm").tolist())))

    @property
    def origin(self) -> Pictures | None:
        """The origin of the pictures, where that is stated."""
        return None if self.pictures is None else Pictures(self.pictures)


def parse_names(text: str) -> dict[str, str]:
    """Return names of cameras by others from ``left=cam0,right=cam1``.

    Raises
    ------
    InputError
        The text has another form, or names a camera twice.
    """
    names: dict[str, str] = {}
    for part in text.split(","):
        first, equals, second = part.partition("=")
        if not (first and equals and second) or first in names:
            raise InputError(
                f"`cameras` pairs each name of the first rig with one of the second, as in "
                f"left=cam0,right=cam1, but '{clipped(printable(text))}' was given."
            )
        names[first] = second
    return names
