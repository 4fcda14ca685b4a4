"""Formats of pictures that labcal does not read, and how to convert them."""

from pathlib import Path

OTHER = frozenset(
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
CAMERA_RAW = frozenset(
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
CONVERT_OTHER = "Convert them to PNG, which loses nothing (ImageMagick: magick mogrify -format png FILES)."
EXPORT_RAW = "Export raw pictures as TIFF of 16 bits, without correction of the lens and without cropping."
_NO_HEADER = (
    "If it holds pixels without a header, state their format: `raw='Mono8:1280x1024'`. If a camera stores "
    "pictures so before it develops them: " + EXPORT_RAW
)
_FILM = frozenset([".mp4", ".mov", ".avi", ".mkv", ".m4v", ".wmv", ".mts", ".webm", ".360"])


def format_advice(path: Path, data: bytes) -> str | None:
    """Return advice on a file of a format that is not read; None where neither name nor content tell one.

    Parameters
    ----------
    path : Path
        Its ending tells the format.
    data : bytes
        The content.
    """
    suffix = path.suffix.lower()
    if suffix == ".raw":
        return _NO_HEADER
    if suffix in CAMERA_RAW:
        return EXPORT_RAW
    if suffix in _FILM:
        return "It is a film. Extract its pictures first (ffmpeg: ffmpeg -i FILM frame%04d.png)."
    if suffix in OTHER or data[4:8] == b"ftyp" or data.startswith(b"GIF8"):
        return CONVERT_OTHER
    return None
