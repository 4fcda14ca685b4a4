"""Checks of what a user registers beside labcal's own: lens models, kinds of targets, methods."""

from collections.abc import Collection, Iterable

from labcal.errors import InputError, InputTypeError
from labcal.run.names import is_name
from labcal.run.user_code import user_code


def require_own_name(what: str, name: object, shipped: Iterable[str], own: Iterable[str]) -> None:
    """Raise unless something of a user's has a name that nothing else has.

    Names become parts of file names, and files whose names differ in capital letters alone are one file on
    some disks.

    Parameters
    ----------
    what : str
        What has the name, for example ``"lens"``.
    name : object
        Should be a text.
    shipped : iterable of str
        Names of labcal's, which are taken.
    own : iterable of str
        Names that were registered before; the same one may be registered again.

    Raises
    ------
    InputError
        It is no name, or it is taken, capital letters apart.
    """
    if not (isinstance(name, str) and is_name(name)):
        raise InputError(f"A {what} needs a name of letters, digits and hyphens, but has {name!r:.80}.")
    alike = [other for other in shipped if other.casefold() == name.casefold()]
    if alike:
        apart = "" if name in alike else f", but for capital letters: '{alike[0]}'"
        raise InputError(f"'{name}' is a name of labcal's already{apart}. Give the {what} another one.")
    for other in own:
        if other.casefold() == name.casefold() and other != name:
            raise InputError(
                f"'{name}' differs from '{other}', which is registered, in capital letters alone. Give the "
                f"{what} another name."
            )


def require_members(what: str, made: object, protocols: Iterable[type], fields: Collection[str] = ()) -> None:
    """Raise unless an object, or a class, has all public members of protocols.

    Parameters
    ----------
    what : str
        What it is and should be, for example ``"The model of 'chess' is no target"``.
    made : object
    protocols : iterable of type
    fields : collection of str
        Members that objects of the class will have.

    Raises
    ------
    InputTypeError
        It lacks some, which are named.
    """
    names = [name for one in protocols for name in vars(one) if not name.startswith("_")]
    missing = []
    for name in dict.fromkeys(names):
        with user_code(f"{what}: its '{name}'"):
            if name not in fields and not hasattr(made, name):
                missing.append(name)
    if missing:
        raise InputTypeError(f"{what}: it lacks {', '.join(missing)}.")
