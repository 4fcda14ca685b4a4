"""Settings of a digital twin."""

from collections.abc import Iterable
from dataclasses import dataclass

from labcal.arguments import one_text, set_checked, truth_value, whole_number

_LEAST_DRAWS = 2


@dataclass(frozen=True)
class TwinSettings:
    """Settings of the twin of a shoot.

    Examples
    --------
    >>> from labcal.pipeline import TwinSettings
    >>> quick = TwinSettings(views=3, spp=64)
    >>> quick.views, quick.draws
    (3, 2)
    """

    views: int | tuple[str, ...] | None = None
    """So many views, spread evenly over the shoot, or the names of views; all where left out."""
    spp: int = 256
    """Rays of a pixel at the edge of a dot; elsewhere a few do."""
    draws: int = 2
    """Pictures with noise of their own that are simulated for each photograph."""
    seed: int = 0
    """Seed of the noise."""
    workers: int = 1
    """Processes that work side by side, one picture each."""
    force: bool = False
    """Replace a twin that is there already."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, or a number is too small.
        """
        numbers = {name: whole_number(getattr(self, name), name, 1) for name in ("spp", "workers")}
        numbers["draws"] = whole_number(self.draws, "draws", _LEAST_DRAWS)
        numbers["seed"] = whole_number(self.seed, "seed", 0)
        set_checked(self, {**numbers, "views": _views(self.views), "force": truth_value(self.force, "force")})


def _views(given: object) -> int | tuple[str, ...] | None:
    """Return the choice of views, checked."""
    if given is None:
        return None
    if isinstance(given, Iterable) and not isinstance(given, str):
        return tuple(one_text(name, "views") for name in given)
    if isinstance(given, str):
        return (one_text(given, "views"),)
    return whole_number(given, "views", 1)
