"""Targets for work that takes one kind alone: grids of dots, or single boards."""

from labcal.errors import InputError
from labcal.targets.board_set import BoardSet
from labcal.targets.catalogue import AnyTarget, load_target, stated_kind
from labcal.targets.grid import DotGrid
from labcal.targets.registry import PLAIN, kind_of
from labcal.targets.target import PrintableTarget
from labcal.wording import listed


def grid_of(target: PrintableTarget, who: str, instead: str = "plain-11x8") -> DotGrid:
    """Return a target that is a grid of dots.

    Parameters
    ----------
    target : PrintableTarget
    who : str
        Subject and verb of what takes nothing else, for the message.
    instead : str
        The name of a target that would do.

    Raises
    ------
    InputError
        It is of another kind.
    """
    if isinstance(target, DotGrid):
        return target
    raise _no_grid(f"the target '{target.name}'", kind_of(target).name, who, instead)


def described_grid(given: object, who: str, instead: str) -> object:
    """Return what a description names as its target, which must be a grid of dots, to be validated.

    Parameters
    ----------
    given : object
        The name of a target, or a description of one.
    who, instead : str
        As of :func:`grid_of`.

    Raises
    ------
    UnknownNameError, InputError
        As of :func:`grid_of` and :func:`~labcal.targets.catalogue.load_target`.
    """
    target = load_target(given) if isinstance(given, str) else given
    if isinstance(target, PrintableTarget):
        return grid_of(target, who, instead)
    if isinstance(target, dict) and (kind := stated_kind(target).name) != PLAIN:
        raise _no_grid("the target", kind, who, instead)
    return target


def single_board(target: AnyTarget, who: str, instead: str) -> AnyTarget:
    """Return a target that is no set of boards side by side.

    Parameters
    ----------
    target : AnyTarget
    who : str
        Subject and verb of what takes one board, for the message.
    instead : str
        A sentence on what to do with several, beside naming one.

    Raises
    ------
    InputError
        It is a set.
    """
    if not isinstance(target, BoardSet):
        return target
    raise InputError(
        f"{who} one board, but '{target.name}' has several ({listed(target.names)}). Name one of them: "
        f"`target='FILE'`. {instead}"
    )


def _no_grid(what: str, kind: str, who: str, instead: str) -> InputError:
    return InputError(
        f"{who} grids of dots only, and {what} is of the kind '{kind}'. Name another one, such as {instead}."
    )
