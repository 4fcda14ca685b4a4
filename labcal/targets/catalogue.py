"""Targets by name, or from a YAML file of one's own."""

from labcal.run.descriptions import description_names, read_description
from labcal.targets.grid import DotGrid

FOLDER = "calib_targets"


def target_names() -> list[str]:
    """Return the names of the targets that labcal ships, sorted."""
    return description_names(FOLDER)


def load_target(name: str) -> DotGrid:
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
    """
    return read_description(DotGrid, "target", FOLDER, name)
