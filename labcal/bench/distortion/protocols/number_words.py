"""A figure of a protocol in words, with as many digits as anybody reads."""

_TEN = 0.0995
"""From here on a share has two digits before its decimal point."""


def number_words(value: float, unit: str) -> str:
    """Return a value with three digits, a share (of the unit ``1``) as percent with two.

    Parameters
    ----------
    value : float
    unit : str

    Examples
    --------
    >>> from labcal.bench.distortion.protocols.number_words import number_words
    >>> number_words(0.998, "1"), number_words(0.0012, "1"), number_words(5.812, "mm")
    ('100%', '0.12%', '5.81')
    """
    if unit != "1":
        return f"{value:.3g}"
    return f"{value:.0%}" if value >= _TEN else f"{100.0 * value:.2g}%"
