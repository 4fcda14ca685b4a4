"""The results of ``labcal reproduce`` as one HTML page that needs nothing beside it."""

import base64
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.report import claims_words, explanations_words, figures_text, study_words
from labcal.report.claims_figure import claim_figure
from labcal.report.reproduction import Reproduction, RowResult, ShownPicture
from labcal.report.reproduction_figures import epoch_figure, error_figure
from labcal.report.row_verdict import RowVerdict
from labcal.report.study_figure import study_figure
from labcal.report.thumbnail import thumbnail
from labcal.run.file_kinds import recognised_by
from labcal.shoot.pictures import read_picture

_HEAD_BYTES = 1024
KIND = recognised_by(
    "a page of 'labcal reproduce'", lambda content: b"of the paper's tables</title>" in content[:_HEAD_BYTES]
)
_PICTURE_WIDTH = 640
_JPEG_QUALITY = 82


_LOOKS = {
    RowVerdict.MATCHES: ("good", "✓"),
    RowVerdict.OTHER_EPOCHS: ("fair", "≈"),
    RowVerdict.SMALLER: ("fair", "↓"),
    RowVerdict.LARGER: ("bad", "↑"),
    RowVerdict.CONTRADICTION: ("odd", "!"),
}
"""Class and sign of each verdict."""
_CLAIM_LOOKS = {"holds": "good", "holds only where": "fair", "does not hold": "bad"}


@dataclass(frozen=True)
class _EmbeddedPicture:
    """A picture as the page holds it; `absent` says why where there is no `data`."""

    shown: ShownPicture
    data: str = ""
    width: int = 0
    height: int = 0
    absent: str = ""


def reproduction_page(result: Reproduction, folder: AnyPath) -> str:
    """Return the page: figures, all rows, how they are read, and the pictures.

    Nothing is fetched from anywhere: styles, figures and pictures are in the page. The same results and
    pictures give the same page.

    Parameters
    ----------
    result : Reproduction
    folder : str or os.PathLike
        Where the pictures of `result` are. One that cannot be read, or lies outside, is said to be missing.
    """
    folder = as_path(folder)
    environment = Environment(
        loader=PackageLoader("labcal.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        metres=_typographic(figures_text.signed_metres),
        percent=_typographic(figures_text.percent),
        millimetres=_typographic(figures_text.millimetres),
        epochs=_typographic(figures_text.epochs),
        goal=_typographic(figures_text.goal),
        verdict_class=_verdict_class,
        verdict_glyph=_verdict_glyph,
        claim_class=lambda verdict: _CLAIM_LOOKS.get(verdict, ""),
        claim_words=claims_words.verdict_words,
        statement_words=claims_words.statement_words,
        ratio_words=lambda one: claims_words.ratio_words(one.ratio, one.interval),
        p_words=claims_words.p_words,
        outcome_words=claims_words.outcome_words,
        goal_words=study_words.goal_words,
        summary_sentences=explanations_words.summary_sentences,
        cause_sentences=explanations_words.cause_sentences,
        divisor_sentences=explanations_words.divisor_sentences,
        size_words=explanations_words.size_words,
        greatest_words=explanations_words.greatest_words,
        likely_words=explanations_words.likely_words,
        rows_words=explanations_words.rows_words,
        length_words=explanations_words.length_words,
        quotient_words=explanations_words.quotient_words,
    )
    rows: tuple[RowResult | str, ...] = (*result.rows, *result.not_reported)
    return environment.get_template("page.html.jinja").render(
        result=result,
        entries=sorted(rows, key=_number),
        tally=_tally(result),
        verdicts=[(verdict.value, verdict.meaning) for verdict in RowVerdict],
        runs=_runs(result),
        errors=Markup(error_figure(result.rows)),  # noqa: S704 - made by matplotlib from numbers
        epochs=Markup(epoch_figure(result.rows)),  # noqa: S704 - the same
        claims=[(claim, Markup(claim_figure(claim))) for claim in result.claims],  # noqa: S704 - the same
        study_figure=Markup(study_figure(result.study)) if result.study else "",  # noqa: S704 - the same
        study_sentences=study_words.study_sentences(result.study),
        pictures=[_embed(picture, folder) for picture in result.pictures],
    )


def missing_pictures(result: Reproduction, folder: AnyPath) -> list[str]:
    """Return the files of pictures that the page cannot show, relative to the folder."""
    folder = as_path(folder)
    return [picture.file for picture in result.pictures if _embed(picture, folder).absent]


def _typographic(write: Callable[..., str]) -> Callable[..., str]:
    """Return a way to write figures with a true minus sign and a dash for what is missing."""

    def written(value: float | int | None) -> str:  # noqa: PYI041 - the checks at run time tell them apart
        text = write(value)
        return "–" if text == figures_text.MISSING else text.replace("-", "−")  # noqa: RUF001 - meant

    return written


def _verdict_class(word: str) -> str:
    return _LOOKS[RowVerdict(word)][0]


def _verdict_glyph(word: str) -> str:
    return _LOOKS[RowVerdict(word)][1]


def _number(row: RowResult | str) -> str:
    return row if isinstance(row, str) else row.exp


def _tally(result: Reproduction) -> list[tuple[RowVerdict, int]]:
    """Return every verdict with the number of its rows."""
    return [(verdict, sum(row.verdict is verdict for row in result.rows)) for verdict in RowVerdict]


def _runs(result: Reproduction) -> str:
    """Return of how many runs the figures are."""
    seeds = sorted({row.seeds for row in result.rows})
    if seeds in ([], [1]):
        return "one run each"
    return f"medians of {' to '.join(map(str, dict.fromkeys((seeds[0], seeds[-1]))))} runs each"


def _embed(picture: ShownPicture, folder: Path) -> _EmbeddedPicture:
    """Return a picture scaled down as a JPEG in base64."""
    path = folder / picture.file
    if not path.resolve().is_relative_to(folder.resolve()):
        return _EmbeddedPicture(picture, absent=f"{picture.file} lies outside the folder of the results.")
    try:
        small = thumbnail(read_picture(path), _PICTURE_WIDTH, _PICTURE_WIDTH)
    except InputError:
        return _EmbeddedPicture(picture, absent=f"{picture.file} is not there any more, or is damaged.")
    done, data = cv2.imencode(".jpg", small[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
    if not done:
        raise InputError(f"The picture {path} cannot be made a JPEG.")
    height, width = small.shape[:2]
    return _EmbeddedPicture(picture, base64.b64encode(data.tobytes()).decode(), width, height)
