"""Libraries that labcal works with but does not need, imported when they are asked for."""

from importlib import import_module
from types import ModuleType

from labcal.errors import DeviceError


def optional_module(name: str, extra: str) -> ModuleType:
    """Import a library that an extra installs.

    Parameters
    ----------
    name : str
        The library's name, for ``import``.
    extra : str
        The extra of labcal that brings it.

    Raises
    ------
    DeviceError
        It is not installed; the message says how to.
    """
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise  # the library is there, but one of its own is not
        raise DeviceError(
            f"This needs the library '{name}', which is not installed. Install it with "
            f"pip install {name} (labcal's extra '{extra}' lists it)."
        ) from error
