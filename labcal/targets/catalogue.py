"""Targets by name, or from a YAML file of one's own."""

from typing import Annotated

from pydantic import Discriminator, Tag

from labcal.run.descriptions import description_content, description_names, validate_description
from labcal.targets.charuco import CharucoBoard
from labcal.targets.grid import DotGrid

FOLDER = "calib_targets"


def _kind(value: object) -> str:
    """Return which kind of target a description or an object is; grids of dots need not say so."""
    is_charuco = isinstance(value, CharucoBoard) or (isinstance(value, dict) and "kind" in value)
    return "charuco" if is_charuco else "dots"


AnyTarget = Annotated[
    Annotated[DotGrid, Tag("dots")] | Annotated[CharucoBoard, Tag("charuco")], Discriminator(_kind)
]
"""A target as it stands in a file: a ChArUco board has a `kind`, a grid of dots has none."""


def target_names() -> list[str]:
    """Return the names of the targets that labcal ships, sorted."""
    return description_names(FOLDER)


def load_target(name: str) -> AnyTarget:
    """Return the target of that name.

    Parameters
    ----------
    name : str
        The name of a shipped target, or the path of a YAML file.

    Raises
    ------
    UnknownNameError
        No target has that name, and no file that path; the nearest name is offered.
    InputError
        The description cannot be read, or a key or value in it is not allowed.

    Examples
    --------
    >>> from labcal import load_target
    >>> target = load_target("rings-10x8")
    >>> target.cols, target.rows, target.pitch_x_mm
    (10, 8, 3.5)
    >>> target.points()[[0, 1, 10]].tolist()  # mm; dots are numbered row by row from the lower left
    [[0.0, 0.0, 0.0], [3.5, 0.0, 0.0], [0.0, 3.5, 0.0]]
    """
    content = description_content("target", FOLDER, name)
    if _kind(content) == "charuco":
        return validate_description(CharucoBoard, "target", name, content)
    return validate_description(DotGrid, "target", name, content)
