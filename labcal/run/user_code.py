"""Code of a user's, imported and run from within labcal: what goes wrong in it is reported as its fault."""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module

from labcal.errors import InputError, LabcalError, UnknownNameError
from labcal.wording import clipped

SEPARATOR = ":"
"""Between the module and the name in it."""
_FORM = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*(\.[^\W\d]\w*)*")


@contextmanager
def user_code(what: str, mend: str = "Set LABCAL_TRACEBACK=1 to see where.") -> Iterator[None]:
    """Convert whatever a user's code raises, and its end of the program, into an error that names it.

    Parameters
    ----------
    what : str
        The part that runs, for example ``"The lens 'mine': its 'distort'"``.
    mend : str
        How to find or to mend the fault.

    Raises
    ------
    InputError
        Any exception was raised, `SystemExit` among them. Errors of labcal and Ctrl-C are let through.
    """
    try:
        yield
    except LabcalError:
        raise
    except (Exception, SystemExit) as error:
        raise InputError(f"{what} failed ({_in_words(error)}). {mend}") from error


@dataclass(frozen=True)
class Place:
    """Words for what ``package.module:name`` should name, for messages.

    Attributes
    ----------
    noun : str
        For example ``"function"``.
    form : str
        Form of the text, with an example.
    kind : str
        What a module holds: ``"class"`` or ``"function"``.
    is_one : callable
        Returns whether an object of the module may be meant; such ones are offered.
    """

    noun: str
    form: str
    kind: str
    is_one: Callable[[object], bool]


def imported(text: str, place: Place) -> object:
    """Return what ``package.module:name`` names; the module is imported.

    Parameters
    ----------
    text : str
    place : Place
        What it should name.

    Raises
    ------
    UnknownNameError
        The module has no such name; the nearest one is offered.
    InputError
        The text has another form, or the module does not exist or cannot be imported.
    """
    if _FORM.fullmatch(text) is None:
        raise InputError(f"'{clipped(text)}' names no {place.noun}. Its form is {place.form}.")
    module, _, path = text.partition(SEPARATOR)
    found = _module(module, text)
    for part in path.split("."):
        with user_code(f"The module '{clipped(module)}'"):
            has_part = hasattr(found, part)
        if not has_part:
            raise UnknownNameError(f"{place.kind} in '{clipped(module)}'", part, _offered(found, place))
        found = getattr(found, part)
    return found


def _module(name: str, text: str) -> object:
    """Import a module."""
    try:
        return import_module(name)
    except (Exception, SystemExit) as error:
        missing = error.name if isinstance(error, ModuleNotFoundError) else None
        if missing is not None and (name == missing or name.startswith(f"{missing}.")):
            raise InputError(
                f"There is no module '{clipped(missing)}', which '{clipped(text)}' names. It is looked for "
                "among the installed packages and in the folder where the command is given."
            ) from error
        raise InputError(f"The module '{clipped(name)}' cannot be imported ({_in_words(error)}).") from error


def _offered(module: object, place: Place) -> list[str]:
    """Return the public names of a module that may be meant; all where there is none."""
    public = {name: value for name, value in vars(module).items() if not name.startswith("_")}
    return [name for name, value in public.items() if place.is_one(value)] or list(public)


def _in_words(error: BaseException) -> str:
    """Return the type and the message of an error, whatever its own code does."""
    try:
        message = str(error)
    except Exception:  # noqa: BLE001 -- it is a user's, too
        message = ""
    return f"{type(error).__name__}: {message}" if message else type(error).__name__
