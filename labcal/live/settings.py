"""Settings of the live page."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from labcal.arguments import set_checked, whole_number
from labcal.errors import InputError
from labcal.paths import AnyPath

if TYPE_CHECKING:
    from labcal.report.page.output import PageOutput

_LAST_PORT = 65_535


def _silent(_address: str) -> None:
    """Do nothing."""


@dataclass(frozen=True)
class LiveSettings:
    """Settings of the live page of a capture.

    Examples
    --------
    >>> from labcal import pipeline
    >>> pipeline.LiveSettings(port=8765, opened=print).port
    8765
    """

    port: int = 0
    """Port on 127.0.0.1; 0: any that is free."""
    opened: Callable[[str], None] = _silent
    """Called with the address of the page, which holds its token, once it can be opened."""
    rig: AnyPath | None = None
    """The calibrated rig to appear; ``SHOOT-rig.json`` beside the shoot where left out."""
    page: "PageOutput | AnyPath | None" = None
    """Page of the calibration to appear; ``SHOOT-rig.html`` beside the shoot where left out."""
    linger_s: float = 300.0
    """After the calibration the page is served until it is closed, or until nobody has looked at it for so
    long, s."""

    def __post_init__(self) -> None:
        """Check the numbers.

        Raises
        ------
        InputError, InputTypeError
            One is of a wrong type or too small or large.
        """
        set_checked(self, {"port": whole_number(self.port, "port", 0)})
        if self.port > _LAST_PORT:
            raise InputError(f"A port is a number from 0 to {_LAST_PORT}, but {self.port} was given.")
        if not self.linger_s >= 0.0:
            raise InputError(f"`linger_s` must be 0 or more, but {self.linger_s} was given.")
