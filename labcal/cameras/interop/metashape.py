"""Agisoft Metashape's file of one camera (Camera Calibration, Save, *.xml).

The formulas are those of the manual's appendix on camera models: Brown's, with K1 to K4, and with P1 and P2
the other way round than OpenCV's p1 and p2; f and f + B1 are the focal lengths along y and x. cx and cy are
offsets from the middle of the picture, whose first pixel has its centre at (0.5, 0.5): they are shifted here
and nowhere else. ``fisheye`` without P1 and P2 is OpenCV's fisheye.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from labcal.cameras.interop.exchange import NOTHING_GIVEN, ReadOptions, ReadRig, SourceText, Unit
from labcal.cameras.interop.lens_parameters import camera_record, fisheye_lens, perspective_lens
from labcal.cameras.interop.numbers_text import finite_number, picture_size
from labcal.cameras.interop.placement import rig_of
from labcal.cameras.interop.read_only import read_only_format
from labcal.cameras.interop.slam_lenses import Lens
from labcal.cameras.interop.xml_tree import read_xml_tree
from labcal.errors import InputError

_ROOT = "calibration"
_COEFFICIENTS = ("k1", "k2", "k3", "k4", "p1", "p2")
_UNREAD = ("p3", "p4", "b2", "skew")
_CORNER = 0.5


def recognises(text: str) -> bool:
    """Tell whether a text is such a file."""
    return "<calibration>" in text and "<projection>" in text and "<f>" in text


def read_metashape(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one camera.

    Raises
    ------
    InputError
        The file is damaged, or has skew or coefficients that labcal's lenses do not have; or there are
        several.
    """
    if len(sources) != 1:
        raise InputError(
            "Files of Metashape hold cameras without their places, so several cannot be placed in one world. "
            "Convert each file alone."
        )
    path = sources[0].path
    root = read_xml_tree(sources[0].text, path)
    if root.tag != _ROOT:
        raise InputError(f"{path}: the outermost element should be {_ROOT}, but is {root.tag:.40}.")
    tags = [child.tag for child in root]
    twice = next((tag for tag in tags if tags.count(tag) > 1), None)
    if twice is not None:
        raise InputError(f"{path}: {twice:.40} occurs twice. Leave one of them.")
    words = {child.tag: (child.text or "").strip() for child in root}
    unread = next((name for name in _UNREAD if _number(words, name, path) != 0.0), None)
    if unread is not None:
        raise InputError(
            f"{path}: {unread} is not zero, which labcal's cameras do not have. Fix it at 0 in Metashape, "
            "and optimise the cameras anew."
        )
    size = picture_size([words.get("width"), words.get("height")], path)
    if "f" not in words:
        raise InputError(f"{path} has no f, the focal length in pixels.")
    f = _number(words, "f", path)
    numbers = (
        f + _number(words, "b1", path),
        f,
        0.5 * size[0] + _number(words, "cx", path) - _CORNER,
        0.5 * size[1] + _number(words, "cy", path) - _CORNER,
    )
    record = camera_record(numbers, _lens(words, path), np.eye(4), size, path)
    return ReadRig(rig_of([path.stem], [record]))


def _number(words: dict[str, str], name: str, path: Path) -> float:
    """Return a number; what is not there is 0."""
    return finite_number(words.get(name, "0"), name, path)


def _lens(words: dict[str, str], path: Path) -> Lens:
    """Return the lens."""
    k1, k2, k3, k4, p1, p2 = (_number(words, name, path) for name in _COEFFICIENTS)
    projection = words.get("projection")
    if projection == "fisheye" and p1 == 0.0 and p2 == 0.0:
        return fisheye_lens((k1, k2, k3, k4))
    if projection == "frame" and k4 == 0.0:
        return perspective_lens((k1, k2, p2, p1, k3))
    raise InputError(
        f"{path}: the projection {projection!r:.40} with these coefficients has no counterpart here; 'frame' "
        "with K4 = 0 and 'fisheye' with P1 = P2 = 0 have. Fix them at 0 in Metashape, and optimise the "
        "cameras anew."
    )


METASHAPE = read_only_format("metashape", (".xml",), recognises, read_metashape, Unit.MILLIMETRES, ())
