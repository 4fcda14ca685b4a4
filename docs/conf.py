"""Configuration of the site: ``sphinx-build -W --keep-going docs docs/_build/html`` builds it."""

import os
import sys
import warnings
from pathlib import Path

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS / "_ext"))
# One thread, as everywhere in labcal: the tutorials render and adjust.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ["COLUMNS"] = "88"  # usage lines of argparse are broken to this width

from labcal import __version__  # noqa: E402 - threads are settled first

project = "labcal"
author = "The labcal developers"
project_copyright = "The labcal developers"
version = release = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx-mathjax-offline",  # formulas are drawn without the network
    "numpydoc",
    "sphinx_gallery.gen_gallery",
    "api_pages",
    "column_table",
    "command_pages",
    "decision_table",
    "detector_settings",
    "distortion_results",
    "member_table",
    "paper_results",
    "registry_table",
    "settings_table",
]
exclude_patterns = ["_build", "_ext", "tutorials", "gallery/.labcal-made", "**sg_execution_times.rst"]
suppress_warnings = ["config.cache"]  # the configuration of sphinx-gallery is not kept between builds

smartquotes = False  # an option begins with two hyphens and not with a dash

# References: every link within the site must lead somewhere.
myst_enable_extensions = ["deflist", "dollarmath", "colon_fence"]
myst_heading_anchors = 3
nitpicky = True
# Names that have no page: types of other libraries (this site is built without the network), and modules of
# labcal that are not public. Public names are checked.
nitpick_ignore_regex = [(r"py:.*", r"(?!labcal\.(pipeline\.)?\w+$).*")]

# Links to other sites are not followed: whether they answer is not a property of this project.
linkcheck_ignore = [r"https?://.*"]

autodoc_typehints = "none"
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

sphinx_gallery_conf = {
    "examples_dirs": ["tutorials"],
    "gallery_dirs": ["auto_tutorials"],
    "filename_pattern": r"plot_",
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "remove_config_comments": True,
    "abort_on_example_error": True,
    "capture_repr": (),  # a page shows what its script prints and draws
    # In this order: the scraper of matplotlib closes the figures of pyplot.
    "image_scrapers": ("returned_figures.returned_figures", "matplotlib"),
    "show_memory": False,
    "min_reported_time": 1,
    "plot_gallery": True,
}
warnings.filterwarnings("ignore", message="Matplotlib is currently using agg")

html_theme = "pydata_sphinx_theme"
html_title = "labcal"
html_show_sourcelink = False
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_theme_options = {
    "navbar_align": "left",
    "show_toc_level": 2,
    "secondary_sidebar_items": ["page-toc"],
    "navigation_with_keys": False,
    "show_prev_next": True,
    "footer_start": ["copyright"],
    "footer_end": ["theme-version"],
}
