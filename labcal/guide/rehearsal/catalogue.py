"""Plans of rigs by name, or from a YAML file."""

from labcal.guide.rehearsal.rig_plan import RigPlan
from labcal.paths import AnyPath, as_text
from labcal.run.descriptions import description_names, read_description

FOLDER = "scenes/rigs"


def rig_plan_names() -> list[str]:
    """Return the names of the plans that labcal ships, sorted."""
    return description_names(FOLDER)


def load_rig_plan(name: AnyPath) -> RigPlan:
    """Return the plan of that name.

    Parameters
    ----------
    name : str or os.PathLike
        The name of a shipped plan, or the path of a YAML file.

    Returns
    -------
    RigPlan

    Raises
    ------
    UnknownNameError
        There is no plan, target or lens of that name; the nearest one is offered.
    InputError
        The description cannot be read, or a value in it is not allowed; every fault is named.

    Examples
    --------
    >>> from labcal import load_rig_plan
    >>> load_rig_plan("narrow").target.name
    'rings-14x10'
    """
    return read_description(RigPlan, "plan of a rig", FOLDER, as_text(name))
