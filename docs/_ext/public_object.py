"""Objects of labcal by ``module:name``, as the directives of this site name them."""

from importlib import import_module


def public_object(where: str) -> object:
    """Return what ``module:name`` names.

    Raises
    ------
    ValueError
        The text has another form, or there is no such name.
    """
    module, colon, name = where.partition(":")
    if not colon:
        raise ValueError(f"'{where}' does not name an object: write module:name.")
    found = getattr(import_module(module), name, None)
    if found is None:
        raise ValueError(f"{module} has no '{name}'.")
    return found
