"""Settings of a rehearsal."""

from dataclasses import dataclass

from labcal.arguments import set_checked, truth_value, whole_number


@dataclass(frozen=True)
class RehearseSettings:
    """Settings of a rehearsal.

    Examples
    --------
    >>> from labcal.pipeline import RehearseSettings
    >>> RehearseSettings(confirm=1, spp=16).seed
    0
    """

    seed: int = 0
    """Seed of the poses to choose from, and of all noise."""
    confirm: int = 0
    """Sets of pictures to render, each with a print and noise of its own, to calibrate from and to measure
    further views with; 0 for none."""
    spp: int = 64
    """Rays a pixel of rendered pictures; fewer add noise that no camera has."""
    workers: int = 1
    """Processes that render and detect."""
    force: bool = False
    """Replace a rehearsal that is there already."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type, or a number is too small.
        """
        set_checked(
            self,
            {
                "seed": whole_number(self.seed, "seed", 0),
                "confirm": whole_number(self.confirm, "confirm", 0),
                "spp": whole_number(self.spp, "spp", 1),
                "workers": whole_number(self.workers, "workers", 1),
                "force": truth_value(self.force, "force"),
            },
        )
