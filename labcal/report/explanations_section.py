"""The explanations of rows 17 to 23, as a section of a page."""

from labcal.report import explanations_words
from labcal.report.explanations import Explanations
from labcal.report.page.document import Section
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.written import Written

_HOW = (
    "The paper prints errors there that are far above those of good pictures. For each mistake that an "
    "experimenter can make, its size was solved for at which our error has the magnitude of the printed one, "
    "on the dots that were detected in the rendered pictures: the median of the seeds, with their range. The "
    "printed figure is read in two ways: as the mean signed error, as in all rows, and as the RMS error of a "
    "coordinate, about that of a single point."
)
_WORDS = (
    explanations_words.cause_sentences,
    explanations_words.divisor_sentences,
    explanations_words.size_words,
    explanations_words.greatest_words,
    explanations_words.likely_words,
    explanations_words.rows_words,
    explanations_words.length_words,
    explanations_words.quotient_words,
)
"""Functions of the template, by their names."""


def explanations_section(found: Explanations) -> Section:
    """Return the section: whether one mistake gives all rows, every mistake, every divisor.

    Parameters
    ----------
    found : Explanations
    """
    values: dict[str, object] = {"found": found, **{words.__name__: words for words in _WORDS}}
    return Section(
        "What would explain rows 17 to 23",
        [
            Prose((_HOW,), Tone.QUIET),
            Prose(tuple(explanations_words.summary_sentences(found))),
            Written("explanations.html.jinja", values),
        ],
    )
