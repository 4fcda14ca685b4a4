"""Plotly's script, which draws the 3-D view; its Python package carries it (MIT licence)."""

from functools import cache
from importlib.resources import files

from labcal.report.page.asset import Asset

NAME = "plotly"


@cache
def plotly_script() -> Asset:
    """Return the script as data of a page: it runs when somebody asks for the 3-D view."""
    return Asset(NAME, files("plotly").joinpath("package_data", "plotly.min.js").read_bytes())
