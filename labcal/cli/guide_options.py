"""Options of a guided capture."""

from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING

from labcal.cli.numbers import numbers
from labcal.errors import InputError
from labcal.run.decimal_words import decimal

if TYPE_CHECKING:
    from labcal.capture.guide_settings import GuideSettings

_LENS, _HAND = "brown5", "5deg,5%"


def add_guide(parser: ArgumentParser) -> None:
    """Describe the options of a guided capture."""
    parser.add_argument(
        "--guided",
        action="store_true",
        help="after each view, tell what was wrong with it, the 3-D error to expect over the volume, and the "
        "pose to take next; end when --wanted-mm is reached",
    )
    parser.add_argument(
        "--wanted-mm",
        type=decimal,
        metavar="MM",
        help="with --guided: RMS 3-D error over the volume at which to end, mm",
    )
    parser.add_argument(
        "--volume-mm",
        metavar="X,Y,Z",
        help="with --guided: sides of the volume to measure in, about the target's place in the first view: "
        "across, upright, in depth (default: what all cameras see there)",
    )
    parser.add_argument(
        "--lens",
        default=_LENS,
        metavar="MODEL",
        help=f"with --guided: lens model of the calibrations on the way (default {_LENS})",
    )
    parser.add_argument(
        "--hand-error",
        default=_HAND,
        metavar="A,D",
        help="with --guided, of sim: errors of the simulated hand, an angle and a share of the distance "
        f"(default {_HAND.replace('%', '%%')})",
    )


def guide_settings(arguments: Namespace) -> "GuideSettings | None":
    """Return the settings of a guided capture; None of a plain one.

    Raises
    ------
    InputError
        An option is for guided captures only, or holds no numbers.
    """
    from labcal.pipeline import GuideSettings

    page = arguments.page and arguments.stage is None
    if not (arguments.guided or page):
        usual = {"wanted_mm": None, "volume_mm": None, "lens": _LENS, "hand_error": _HAND}
        given = [f"--{name.replace('_', '-')}" for name in usual if getattr(arguments, name) != usual[name]]
        if given:
            raise InputError(
                f"Only guided captures have {' and '.join(given)}. Add --guided, or leave it out."
            )
        return None
    sides = numbers(arguments.volume_mm, "volume_mm") or None
    return GuideSettings(arguments.wanted_mm, sides, arguments.lens, arguments.hand_error)
