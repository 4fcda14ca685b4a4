"""Pictures in folders that are left out, since their format is not read."""

from collections.abc import Sequence
from pathlib import Path

from labcal.correspond.picture_folders import picture_folders
from labcal.wording import counted, listed

_SHOWN = 3
_OTHER = frozenset(
    [
        ".gif",
        ".heic",
        ".heif",
        ".hif",
        ".avif",
        ".jp2",
        ".j2k",
        ".jxl",
        ".jfif",
        ".jpe",
        ".pam",
        ".pfm",
        ".hdr",
        ".tga",
        ".psd",
        ".dib",
        ".pcx",
        ".ras",
    ]
)
"""Endings of pictures that other programs convert without a loss."""
_RAW = frozenset(
    [
        ".raw",
        ".dng",
        ".cr2",
        ".cr3",
        ".crw",
        ".nef",
        ".nrw",
        ".arw",
        ".sr2",
        ".srf",
        ".raf",
        ".orf",
        ".rw2",
        ".pef",
        ".srw",
        ".x3f",
        ".iiq",
        ".3fr",
        ".erf",
        ".mrw",
        ".kdc",
        ".dcr",
        ".mos",
        ".rwl",
        ".gpr",
    ]
)
"""Endings of pictures that a camera stores before it develops them."""


def left_out_words(paths: Sequence[str]) -> list[str]:
    """Return a message about pictures in folders whose format is not read, and how to convert them.

    Parameters
    ----------
    paths : sequence of str
        Files and folders as given for pictures; a file that is named is never left out.
    """
    entries = [
        entry
        for given in paths
        if Path(given).is_dir()
        for folder in picture_folders(Path(given))
        for entry in sorted(folder.iterdir())
    ]
    messages = []
    for endings, mend in (
        (_OTHER, "Convert them to PNG, which loses nothing (ImageMagick: magick mogrify -format png FILES)."),
        (
            _RAW,
            "Export raw pictures as TIFF of 16 bits, without correction of the lens and without cropping.",
        ),
    ):
        names = [str(entry) for entry in entries if entry.suffix.lower() in endings]
        if names:
            kinds = ", ".join(sorted({Path(name).suffix.lower() for name in names}))
            messages.append(
                f"{counted(len(names), 'picture')} left out, since files that end in {kinds} are not read: "
                f"{listed(names, _SHOWN)}. {mend}"
            )
    return messages
