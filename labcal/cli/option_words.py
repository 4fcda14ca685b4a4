"""Messages of the library in the words of the command line.

The library speaks of arguments, as a notebook has them, between backticks: ```force=True```,
```lens='auto'```, ```size```. A person at a terminal has options: ``--force``, ``--lens auto``, ``--size``.
"""

import re

OPTIONS = {
    name: "--" + name.replace("_", "-")
    for name in (
        "alignment", "budget", "cameras", "date", "detections", "distance_mm", "dots", "dpi", "every",
        "exposure_us", "force", "gain", "hold_out", "interval_s", "key", "lens", "max_skew_ms", "log",
        "method", "note", "only", "plan", "quick", "raw", "rectify", "rendered", "rig", "scheduler", "seed",
        "seeds", "size", "spp", "stage", "start", "target", "temperature_c", "timeout_s", "tone_curve",
        "tries", "unit",
        "print_scale", "copy", "video_offset", "views", "whole", "workers", "yes",
    )
} | {
    "overrides": "--set", "from_format": "--from", "to_format": "--to", "groups": "--only",
    "methods": "--method", "parts": "--holdout",
    "columns": "--columns", "frame": "--frame", "frame_view": "--frame-view", "likelihood": "--likelihood",
    "pixel_sigma": "--pixel-sigma", "reference_view": "--reference-view",
    "scale_bars": "--scale-bar", "scale_sigma_ppm": "--scale-sigma-ppm",
    "limit_mm": "--limit-mm", "limit_ppm": "--limit-ppm", "confidence": "--confidence",
    "volume_mm": "--volume-mm", "longest_mm": "--longest-mm", "operator": "--operator",
    "hand_error": "--hand-error", "wanted_mm": "--wanted-mm",
    "distances_mm": "--distances-mm", "pictures": "--pictures",
    "mark_diameter": "--mark-diameter", "markers": "--markers",
    "paper": "--paper", "tiles": "--tiles",
}  # fmt: skip
"""Options by the names of the arguments that they stand for."""

SWITCHES = {
    "dot_places='declared'": "--keep-dots", "dot_places='freed'": "--free-dots", "dot_places": "--free-dots",
    "lenses='fixed'": "--fix-intrinsics", "rehearsal=False": "--no-rehearsal",
    "copy=None": "--plain",
}  # fmt: skip
"""Options by the values of arguments that they stand for."""

_ARGUMENT = re.compile(r"`([a-z_]+)(?:=(True|'[^'`]*'|[\w.]+))?`")
_PLAIN = re.compile(r"[\w.,:/-]+")
WORDS = frozenset(
    (
        "message", "reason", "warnings", "notes", "error", "skipped", "why", "left_out", "centre_bias_kept",
        "inconsistent", "causes", "refused", "mend_refused", "mend", "words",
    )
)  # fmt: skip
"""Keys of JSON documents that hold messages; under others stand data, which are never changed."""


def in_options(message: str) -> str:
    """Return a message that speaks of options in place of arguments."""
    return _ARGUMENT.sub(_option, message)


def _option(found: re.Match[str]) -> str:
    name, value = found.groups()
    if found[0].strip("`") in SWITCHES:
        return SWITCHES[found[0].strip("`")]
    if name not in OPTIONS:
        return found[0]
    if value in (None, "True"):
        return OPTIONS[name]
    text = value.strip("'")
    return f"{OPTIONS[name]} {text if _PLAIN.fullmatch(text) else value}"


def document_in_options(tree: object, *, words: bool = False) -> object:
    """Return plain data of a JSON document whose messages speak of options.

    Parameters
    ----------
    tree : object
        As :func:`labcal.run.json_text.plain_data` makes it.
    words : bool
        It stands under a key that holds messages.
    """
    if isinstance(tree, str):
        return in_options(tree) if words else tree
    if isinstance(tree, list):
        return [document_in_options(item, words=words) for item in tree]
    if isinstance(tree, dict):
        return {key: document_in_options(item, words=key in WORDS) for key, item in tree.items()}
    return tree
