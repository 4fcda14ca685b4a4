"""The figures that ``plot()`` returns, on the pages of the tutorials.

pyplot does not know such figures, so that sphinx-gallery's own scraper of matplotlib passes over them.
"""

from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

_SHOWN = "__shown_figures__"


def returned_figures(_block: object, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the figures that a block of a tutorial has bound to names, and return what shows them."""
    names = block_vars["example_globals"]
    shown = names.setdefault(_SHOWN, [])
    figures = [one for one in names.values() if isinstance(one, Figure)]
    new = [one for one in figures if not any(one is old for old in shown)]
    shown.extend(new)
    paths = []
    returned = [one for one in new if one.canvas.manager is None]  # those of pyplot have a manager
    for figure, path in zip(returned, block_vars["image_path_iterator"], strict=False):
        figure.savefig(path)
        paths.append(path)
    return str(figure_rst(paths, gallery_conf["src_dir"]))
