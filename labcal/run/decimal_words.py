"""Numbers in words of text files, as every program writes them."""

_SPACE = " \t\r\n"


def decimal(word: str) -> float:
    """Return the number that a word is; ``nan`` and ``inf`` are numbers.

    Python alone takes ``1_0`` for 10, digits of other scripts for numbers, and control characters for spaces,
    one of which may be what is left of a minus sign.

    Raises
    ------
    ValueError
        It is none.
    """
    if "_" in word or not word.isascii() or word.strip(_SPACE) != word.strip():
        raise ValueError(word)
    return float(word)
