"""Figures of matplotlib as SVG that stands in an HTML page and takes the page's colours and font."""

import io
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import matplotlib as mpl
from matplotlib.figure import Figure


@dataclass(frozen=True)
class Ink:
    """A colour of a figure: `drawn` by matplotlib, replaced by the page's `css`."""

    drawn: str
    css: str


# Odd values, which nothing else in a figure has.
TEXT = Ink("#101112", "var(--ink)")
QUIET = Ink("#717273", "var(--quiet)")
LINE = Ink("#d1d2d3", "var(--line)")
OURS = Ink("#1f66aa", "var(--ours)")
SECOND = Ink("#c46a1b", "var(--second)")
GROUND = Ink("#fdfcfb", "var(--ground)")
_INKS = (TEXT, QUIET, LINE, OURS, SECOND, GROUND)


@contextmanager
def page_style() -> Iterator[None]:
    """Let matplotlib draw in the colours of this module meanwhile."""
    style = mpl.RcParams(
        {
            "svg.fonttype": "none",
            "font.family": ["DejaVu Sans"],
            "font.size": 9.0,
            "text.color": TEXT.drawn,
            "axes.edgecolor": LINE.drawn,
            "axes.labelcolor": QUIET.drawn,
            "xtick.color": LINE.drawn,
            "ytick.color": LINE.drawn,
            "xtick.labelcolor": QUIET.drawn,
            "ytick.labelcolor": TEXT.drawn,
        }
    )
    with mpl.rc_context(style):
        yield


def inline_svg(figure: Figure, name: str, description: str) -> str:
    """Return a figure as an ``<svg>`` element; the same figure gives the same text.

    Parameters
    ----------
    figure : Figure
        Drawn in the colours of this module.
    name : str
        Begins every id in the element, so that several figures can stand in one page.
    description : str
        What the figure shows, for those who cannot see it; plain text without markup.
    """
    text = io.StringIO()
    metadata = {"Date": None}
    with page_style(), mpl.rc_context({"svg.hashsalt": name}), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")  # of a name in letters that the font does not have
        figure.savefig(text, format="svg", transparent=True, metadata=metadata)
    svg = text.getvalue()
    svg = svg[svg.index("<svg") :]
    # A style element would hold for the whole page.
    svg = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>", "", svg, flags=re.DOTALL)
    svg = re.sub(r' xmlns(:\w+)?="[^"]*"', "", svg).replace("xlink:href", "href")
    svg = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{name}-", svg)
    svg = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", svg))
    svg = svg.replace("<svg", f'<svg role="img" aria-label="{description}" stroke-linejoin="round"', 1)
    svg = re.sub(r"'DejaVu Sans'[^;\"]*", "inherit", svg)
    svg = re.sub(r"font: ([^;\"]*?)([\d.]+)px inherit", r"font-size: \2px", svg)
    for ink in _INKS:
        svg = svg.replace(ink.drawn, ink.css)
    return svg
