"""The results of ``labcal reproduce`` as one HTML page that needs nothing beside it."""

import base64
from dataclasses import dataclass
from pathlib import Path

import cv2
from markupsafe import Markup

from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.report import claims_words
from labcal.report.claims_figure import claim_figure
from labcal.report.explanations_section import explanations_section
from labcal.report.page.beside import Beside
from labcal.report.page.chart import Chart
from labcal.report.page.document import PAGE_KIND, Page, Section
from labcal.report.page.download import Download
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.provenance import Provenance
from labcal.report.page.templates import rendered
from labcal.report.page.written import Written
from labcal.report.reproduction import RESULTS, Reproduction, RowResult, ShownPicture
from labcal.report.reproduction_figures import epoch_figure, error_figure
from labcal.report.row_verdict import RowVerdict
from labcal.report.study_section import study_section
from labcal.report.thumbnail import thumbnail
from labcal.run.file_kinds import recognised_by
from labcal.run.tables import table_text
from labcal.shoot.pictures import read_picture

_HEAD_BYTES = 1024
_ONCE = b"of the paper's tables</title>"
"""In pages of earlier versions."""
KIND = recognised_by(
    "a page of 'labcal reproduce'",
    lambda content: PAGE_KIND.recognises(content) or _ONCE in content[:_HEAD_BYTES],
)
_ROWS = 23
"""Of the paper, with those that it names and does not report."""
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
    rows: tuple[RowResult | str, ...] = (*result.rows, *result.not_reported)
    values: dict[str, object] = {
        "result": result,
        "entries": sorted(rows, key=_number),
        "tally": _tally(result),
        "verdicts": [(verdict.value, verdict.meaning) for verdict in RowVerdict],
        "runs": _runs(result),
        "verdict_class": _verdict_class,
        "verdict_glyph": _verdict_glyph,
    }
    sections = []
    if result.rows:
        sections = [
            Section("At a glance", [Beside((_error_chart(result), _epoch_chart(result)))]),
            Section("Every row", [Written("reproduction_rows.html.jinja", values)]),
        ]
    if result.claims:
        sections.append(Section("The claims", [_claims(result)]))
    if result.study:
        sections.append(study_section(result.study))
    if result.explanations:
        sections.append(explanations_section(result.explanations))
    if result.rows:
        reading = Written("reproduction_reading.html.jinja", values)
        sections.append(Section("How a row is read", [reading]))
    if result.rows and result.not_reported:
        sections.append(Section("Not reported", [Prose((_not_reported(result),))]))
    if result.pictures:
        shown = {"pictures": [_embed(picture, folder) for picture in result.pictures]}
        pictures = Written("reproduction_pictures.html.jinja", shown)
        sections.append(Section("What the cameras saw", [Prose((_CAMERAS,)), pictures]))
    tally = [Written("reproduction_tally.html.jinja", values)] if result.rows else []
    kind = "Quick reproduction" if result.quick else "Reproduction"
    return Page(
        title=f"{kind} of the paper's tables",
        heading="The paper's tables, reproduced",
        lead=_LEAD,
        sections=sections,
        provenance=_provenance(result, folder),
        opening=[*_quick_note(result), *tally],
    ).text()


_LEAD = (
    "Every row that “Applying Neural Networks in 3-D Vision” reports, computed again: 3-D points from the "
    "pixels of two cameras, by neural networks and by least squares, on simulated points and on "
    "rendered pictures with detected dots."
)
_CAMERAS = (
    "The paper used hardware for rows 17 to 23. Here a rendered shoot stands in for it: dots are detected in "
    "pictures like these, and the solvers see the detections only."
)
_ERRORS = (
    "The paper's error is a mean of signed errors, in which large errors cancel. The diamond shows what it "
    "hides: the RMS length of our 3-D error on points that were not trained on. Errors below 0.0001 mm stand "
    "at the edge."
)


def _error_chart(result: Reproduction) -> Chart:
    """Return the errors of all rows, with their numbers."""
    header = ("exp", "mean_signed_m", "paper_abs_m", "mae_mm", "rmse_mm", "p95_mm", "max_mm", "verdict")
    lines = [[getattr(row, name) for name in header] for row in result.rows]
    return Chart(
        "errors", error_figure(result.rows), _ERRORS, Download("errors.csv", table_text(header, lines))
    )


def _epoch_chart(result: Reproduction) -> Chart:
    """Return the epochs of all rows, with their numbers."""
    header = ("exp", "epochs", "paper_epochs", "goal_reached", "seconds")
    lines = [[getattr(row, name) for name in header] for row in result.rows]
    file = Download("epochs.csv", table_text(header, lines))
    return Chart(
        "epochs", epoch_figure(result.rows), "Training steps until the goal. Least squares has none.", file
    )


def _quick_note(result: Reproduction) -> list[Part]:
    """Return what a quick run left out."""
    if not result.quick:
        return []
    paragraphs = (
        "This was a quick run: a check that everything works, not the paper's conditions.",
        *(f"• {restriction}" for restriction in result.restrictions),
        "Run 'labcal reproduce' in full for figures to quote.",
    )
    return [Prose(paragraphs, Tone.NOTE)]


def _not_reported(result: Reproduction) -> str:
    rows = "Row" if len(result.not_reported) == 1 else "Rows"
    return (
        f"{rows} {', '.join(result.not_reported)}: named in the paper's text, absent from its tables, so "
        "there is nothing to compare with."
    )


def _provenance(result: Reproduction, folder: Path) -> Provenance:
    """Return the command that gives these results; ``labcal report`` makes the page of them again."""
    words = {
        "rows": _experiments(result),
        "seeds": max((*(row.seeds for row in result.rows), *(cell.seeds for cell in result.study), 0)),
        "result": result,
    }
    command = str(rendered("reproduction_command.txt.jinja", words)).strip()
    return Provenance.of(command, [RESULTS], folder)


def _experiments(result: Reproduction) -> list[str]:
    """Return the names of the experiments for the command, none where it was all of them."""
    every_row = len(result.rows) + len(result.not_reported) == _ROWS
    if every_row and result.claims and result.study and result.explanations:
        return []
    studies = {"study": result.study, "explanations": result.explanations}
    return [
        *(row.exp for row in result.rows),
        *(claim.claim for claim in result.claims),
        *(name for name, found in studies.items() if found),
    ]


def missing_pictures(result: Reproduction, folder: AnyPath) -> list[str]:
    """Return the files of pictures that the page cannot show, relative to the folder."""
    folder = as_path(folder)
    return [picture.file for picture in result.pictures if _embed(picture, folder).absent]


def _claims(result: Reproduction) -> Written:
    """Return the claims with their figures."""
    values: dict[str, object] = {
        "claims": [(claim, Markup(claim_figure(claim))) for claim in result.claims],  # noqa: S704 -- matplotlib's
        "plan": result.claims_plan_sha256 or "",
        "claim_class": lambda verdict: _CLAIM_LOOKS.get(verdict, ""),
        "claim_words": claims_words.verdict_words,
        "statement_words": claims_words.statement_words,
        "ratio_words": lambda one: claims_words.ratio_words(one.ratio, one.interval),
        "p_words": claims_words.p_words,
        "outcome_words": claims_words.outcome_words,
    }
    return Written("claims.html.jinja", values)


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
