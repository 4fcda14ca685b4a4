"""The formats of named pixels by name."""

from labcal.correspond.interop.pixels.colmap_tracks import COLMAP_TRACKS
from labcal.correspond.interop.pixels.dice_subsets import DICE_SUBSETS
from labcal.correspond.interop.pixels.dlc import DLC
from labcal.correspond.interop.pixels.exchange import PixelFormat
from labcal.correspond.interop.pixels.named_columns import COLUMNS

PIXEL_FORMATS: dict[str, PixelFormat] = {one.name: one for one in (COLMAP_TRACKS, DLC, DICE_SUBSETS, COLUMNS)}
