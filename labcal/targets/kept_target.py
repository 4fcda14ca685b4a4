"""The target that a rig was calibrated with, kept in the rig."""

from pydantic import TypeAdapter, ValidationError

from labcal.cameras.rig import Rig
from labcal.cameras.target_record import TargetRecord
from labcal.errors import InputError
from labcal.run.descriptions import explain_validation
from labcal.targets.catalogue import BOARDS_KEY, AnyTarget, DescribedTarget
from labcal.targets.places import DotPlaces
from labcal.targets.target import PrintableTarget, Target

_FOR_PEOPLE = {"name", "description"}
_OF_A_PLATE = {"places", "mounting"}


def target_record(target: AnyTarget) -> TargetRecord:
    """Return the description of a target as a rig keeps it."""
    return TargetRecord.model_validate(target.model_dump(mode="json"))


def kept_target(rig: Rig) -> AnyTarget | None:
    """Return the target that a rig was calibrated with.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    AnyTarget or None
        None if the rig states none, as those of older files and of other programs.

    Raises
    ------
    InputError
        The description is damaged, or of a kind that is not registered here.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> from labcal.targets.kept_target import kept_target
    >>> rig = pipeline.calibrate(examples.TARGET, examples.detections()).rig
    >>> kept_target(rig).name
    'plain-11x8'
    """
    if rig.target is None:
        return None
    try:
        target: AnyTarget = TypeAdapter(DescribedTarget).validate_python(rig.target.root)
    except ValidationError as error:
        raise InputError(
            f"The target that the rig states cannot be used: {explain_validation(error)}. Name the target: "
            "`target='NAME'`."
        ) from error
    return target


def other_target_note(rig: Rig, shown: Target | DotPlaces) -> str | None:
    """Return a note if dots are taken for another target's than that of the rig's calibration; else None.

    Parameters
    ----------
    rig : Rig
    shown : Target or DotPlaces
        Its name and its text for people are not compared.
    """
    shown = shown.target if isinstance(shown, DotPlaces) else shown
    if rig.target is None or not isinstance(shown, PrintableTarget):
        return None
    given, kept = target_record(shown).root, rig.target.root
    boards = kept.get(BOARDS_KEY)
    for board in boards if isinstance(boards, list) else ():
        if isinstance(board, dict) and board.get("name") == shown.name:  # one of several
            kept = board
    keys = (given.keys() | kept.keys()) - _FOR_PEOPLE - _OF_A_PLATE
    different = sorted(key for key in keys if given.get(key) != kept.get(key))
    if not different:
        return None
    return (
        f"the dots are taken for those of the target '{shown.name}', but the rig was calibrated with "
        f"'{rig.target.name}' (they differ in {', '.join(different)}). If the pictures show the latter, name "
        f"it: `target='{rig.target.name}'`"
    )
