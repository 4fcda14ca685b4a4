"""Numbers in words of text files, as every program writes them."""


def decimal(word: str) -> float:
    """Return the number that a word is; ``nan`` and ``inf`` are numbers.

    Python alone takes ``1_0`` for 10, and digits of other scripts for numbers.

    Raises
    ------
    ValueError
        It is none.
    """
    if "_" in word or not word.isascii():
        raise ValueError(word)
    return float(word)
