"""Table of pictures and of what came of each, for people."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rich.table import Table

from labcal.correspond.refused_pictures import shared_reasons
from labcal.report.columns import name_column


@dataclass(frozen=True)
class PictureLine:
    """One picture of the table.

    Attributes
    ----------
    image : str
    found : str
        What was measured in it, in words.
    reason : str or None
        Of a refusal.
    flags : dict
        Number of what is not used, by flag.
    """

    image: str
    found: str
    reason: str | None
    flags: dict[str, int]


def picture_table(pictures: Sequence[PictureLine], column: str, captions: Sequence[str]) -> Table:
    """Return the table; a reason that several pictures share stands once, below it.

    Parameters
    ----------
    pictures : sequence of PictureLine
    column : str
        Head of what was measured.
    captions : sequence of str
        Lines below the reasons.
    """
    shared = shared_reasons([(one.image, one.reason) for one in pictures if one.reason is not None])
    several = {image for reason in shared if len(reason.images) > 1 for image in reason.images}
    reasons = [reason.words for reason in shared if len(reason.images) > 1]
    caption = "\n".join([*reasons, *captions])
    table = Table(name_column("picture"), column, "result", caption=caption, caption_justify="left")
    for one in pictures:
        others = ", ".join(f"{count} {flag}" for flag, count in one.flags.items())
        came = one.reason or ("ok" if not others else f"ok; not used: {others}")
        table.add_row(one.image, one.found, "refused, see below" if one.image in several else came)
    return table


def unused_flags(flags: Iterable[str]) -> dict[str, int]:
    """Return how often each flag but ``ok`` occurs, by name."""
    return dict(sorted(Counter(str(flag) for flag in flags if flag != "ok").items()))
