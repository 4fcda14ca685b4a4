"""A known distance between two named points."""

from dataclasses import dataclass
from math import isfinite

from labcal.bounds import MOST_MM
from labcal.errors import InputError
from labcal.wording import clipped, printable

_FORM = "Give it as ONE,OTHER,LENGTH,SIGMA, such as 'a,b,500.02,0.005' (mm)"
_LEAST_SIGMA_MM = 1e-9


@dataclass(frozen=True)
class ScaleBar:
    """Two points whose distance was measured otherwise, in every view that shows both.

    Raises
    ------
    InputError
        The points are one, or the length or its standard deviation is none.

    Examples
    --------
    >>> ScaleBar.of("origin,tip,75.46,0.01")
    ScaleBar(one='origin', other='tip', length_mm=75.46, sigma_mm=0.01)
    """

    one: str
    other: str
    """Names of the points."""
    length_mm: float
    sigma_mm: float
    """Standard deviation of the length: the same error in all views."""

    def __post_init__(self) -> None:
        """Check names and figures."""
        if self.one == self.other or not (self.one and self.other):
            raise InputError(f"A scale bar takes two different points, not '{self.one}' and '{self.other}'.")
        if not (isfinite(self.length_mm) and 0.0 < self.length_mm <= MOST_MM):
            raise InputError(f"The length of {self.name} is a positive number of mm, not {self.length_mm}.")
        if not (isfinite(self.sigma_mm) and _LEAST_SIGMA_MM <= self.sigma_mm <= MOST_MM):
            raise InputError(
                f"The standard deviation of {self.name} is a positive number of mm, not {self.sigma_mm}: how "
                "far off its length may be, by its certificate or by how it was measured."
            )

    @property
    def name(self) -> str:
        """The bar in messages."""
        return f"the scale bar '{clipped(printable(self.one))}' to '{clipped(printable(self.other))}'"

    @classmethod
    def of(cls, given: object) -> "ScaleBar":
        """Return the bar that words such as ``a,b,500.02,0.005`` name; one that is a bar already stays.

        Raises
        ------
        InputError
            They name none.
        """
        if isinstance(given, ScaleBar):
            return given
        parts = given.split(",") if isinstance(given, str) else ()
        if len(parts) != 4:  # noqa: PLR2004 -- two names, length, sigma
            raise InputError(f"'{clipped(printable(str(given)))}' is no scale bar. {_FORM}.")
        one, other, *figures = (part.strip() for part in parts)
        try:
            length, sigma = map(float, figures)
        except ValueError as error:
            raise InputError(
                f"'{clipped(printable(str(given)))}' is no scale bar: {error}. {_FORM}."
            ) from error
        return cls(one, other, length, sigma)
