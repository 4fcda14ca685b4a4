"""Solutions of DICe: a table of subsets for each picture of a camera.

A subset stands at its coordinates in the reference picture plus its displacement; DICe counts from the
centre of the upper left pixel. A negative SIGMA says that the subset was not found.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from labcal.correspond.interop.pixels.exchange import PixelFormat, PixelOptions, ReadPixels
from labcal.correspond.interop.pixels.named_columns import ColumnChoice, read_chosen
from labcal.correspond.named_pixels import NamedPixels

_CHOICE = ColumnChoice(
    {"camera": (("COORDINATE_X", "DISPLACEMENT_X"), ("COORDINATE_Y", "DISPLACEMENT_Y"))},
    point="SUBSET_ID",
    sigma="SIGMA",
)


def read_dice(paths: Sequence[Path], given: PixelOptions) -> ReadPixels:
    """Read solutions of DICe, one file for each camera of each view, named by the file.

    Raises
    ------
    InputError
        A file is no such table or damaged, or its camera is not known.
    """
    found = read_chosen(paths, _CHOICE, given)
    every = found.pixels
    # SIGMA foretells the error by assumed noise, not that of these pictures.
    pixels = NamedPixels(every.view, every.camera, every.point, every.position)
    note = (
        "SIGMA of DICe is no measured noise and was not taken for one; state it when measuring: `pixel_sigma`"
    )
    return replace(found, pixels=pixels, notes=(*found.notes, note))


DICE_SUBSETS = PixelFormat(
    "dice-subsets", "DICe_solution_*.txt, one a camera and view", ("cameras",), read_dice
)
