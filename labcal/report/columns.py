"""Columns of tables for people."""

from rich.table import Column


def name_column(title: str) -> Column:
    """Return a column whose cells are broken into lines where they are too wide, and never cut.

    Names often differ in their last letters alone.
    """
    return Column(title, overflow="fold", min_width=8)
