"""Numbers in an option, with commas between them."""

from labcal.errors import InputError
from labcal.run.decimal_words import decimal
from labcal.wording import clipped, printable


def numbers(text: str | None, name: str) -> tuple[float, ...]:
    """Return the numbers of an option; none where it is not given.

    Parameters
    ----------
    text : str or None
        Such as ``600,800.5``.
    name : str
        Of the argument that the option stands for.

    Raises
    ------
    InputError
        A part of it is no number.
    """
    if text is None:
        return ()
    try:
        return tuple(decimal(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            f"`{name}` takes numbers with commas between them, as in 600,800, but "
            f"'{clipped(printable(text))}' was given."
        ) from None
