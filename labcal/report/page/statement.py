"""The outcome of a piece of work, in one sentence at the top of its page."""

from collections.abc import Callable
from dataclasses import dataclass

from markupsafe import Markup

from labcal.evaluate.verdict.verdict import Belief, Verdict
from labcal.report.page.part import Part
from labcal.report.page.templates import rendered

_TONES = {Belief.YES: "good", Belief.PARTLY: "fair", Belief.NO: "bad"}


@dataclass(frozen=True)
class Statement(Part):
    """A verdict as a page shows it.

    Attributes
    ----------
    verdict : Verdict
    phrase : callable
        What turns a message of the library into the reader's words: of arguments, or of options.
    """

    verdict: Verdict
    phrase: Callable[[str], str]

    def html(self) -> Markup:
        """Return the sentence, its four parts, and what its figure leaves out."""
        return rendered("statement.html.jinja", {"statement": self})

    @property
    def tone(self) -> str:
        """The name of its style."""
        return _TONES[self.verdict.belief]

    @property
    def sentence(self) -> str:
        """The verdict in one sentence."""
        return self.phrase(self.verdict.sentence)

    @property
    def terms(self) -> list[tuple[str, str]]:
        """The same, part by part."""
        verdict = self.verdict
        reasons = "; ".join(verdict.reasons)
        parts = {
            "Expect": verdict.expectation,
            "Believe it?": f"{verdict.belief.value}{': ' if reasons else ''}{reasons}",
            "Limited by": verdict.limit,
            "Do next": verdict.advice,
        }
        return [(word, _as_sentence(self.phrase(text))) for word, text in parts.items()]

    @property
    def leaves_out(self) -> list[str]:
        """Errors that the expected one does not hold."""
        return [_as_sentence(self.phrase(one)) for one in self.verdict.leaves_out]


def _as_sentence(text: str) -> str:
    """Return a text with a capital letter and a full stop."""
    return f"{text[:1].upper()}{text[1:]}{'' if text.endswith('.') else '.'}"
