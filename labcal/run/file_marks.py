"""Marks in single files, by which labcal knows again what it wrote, and that nobody has changed it since.

A mark is a comment, or what a format has in its place, and holds SHA-256 of all else in the file. Readers of
the format pass over it. Formats of labcal's own need none: they are told by how they begin.
"""

import hashlib
import re
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

_SAYS = b"Made by labcal; SHA-256 of all else in this file: "
_MARK = re.compile(re.escape(_SAYS) + rb"[0-9a-f]{64}")
_SOI_BYTES, _IHDR_END = 2, 33
_JFIF = b"\xff\xe0"
_COMMENTS = re.compile(rb"(?:(?:#|%|---)[^\n]*\n)*")
_XML_DECLARATION = re.compile(rb"(?:<\?xml[^>]*>\n)?")


class Judgement(Enum):
    """What a file's mark says of it."""

    AS_WRITTEN = "labcal wrote it so"
    CHANGED = "labcal wrote it, but it has been changed since"
    UNMARKED = "labcal did not write it, or a version without marks"


@dataclass(frozen=True)
class DigestMark:
    """A mark for formats that others write, too."""

    block: Callable[[bytes], bytes]
    """Takes what the mark says; returns the piece of the file that says it."""
    place: Callable[[bytes], int]
    """Takes the content without a mark; returns where in it the piece goes."""

    def put(self, content: bytes) -> bytes:
        """Return a file's content with the mark."""
        at = self.place(content)
        return content[:at] + self._piece(content) + content[at:]

    def judge(self, content: bytes) -> Judgement:
        """Return what a file's whole content says."""
        found = _MARK.search(content)
        if found is None:
            return Judgement.UNMARKED
        rest = content.replace(self.block(found[0]), b"", 1)
        return Judgement.AS_WRITTEN if self.put(rest) == content else Judgement.CHANGED

    def _piece(self, content: bytes) -> bytes:
        return self.block(_SAYS + hashlib.sha256(content).hexdigest().encode())


@dataclass(frozen=True)
class FormatMark:
    """The mark of a format that nobody but labcal writes: the format itself."""

    tells: Callable[[bytes], bool]
    """Takes a file's content."""

    def put(self, content: bytes) -> bytes:
        """Return the content as it is."""
        return content

    def judge(self, content: bytes) -> Judgement:
        """Return what a file's content says: whether it is of the format."""
        return Judgement.AS_WRITTEN if self.tells(content) else Judgement.UNMARKED


class TextMark:
    """A comment in a text: of XML where it begins as XML does, else a line."""

    def put(self, content: bytes) -> bytes:
        """Return a file's content with the mark."""
        return self._mark(content).put(content)

    def judge(self, content: bytes) -> Judgement:
        """Return what a file's whole content says."""
        return self._mark(content).judge(content)

    def _mark(self, content: bytes) -> DigestMark:
        return XML_COMMENT if content.startswith(b"<") else LINE_COMMENT


FileMark = DigestMark | TextMark | FormatMark
"""How files of a format that labcal wrote are told from all others."""


def _png_chunk(says: bytes) -> bytes:
    """Return a text with the keyword that PNG has for the program that made a picture."""
    chunk = b"tEXt" + b"Software\0" + says
    return (len(chunk) - 4).to_bytes(4, "big") + chunk + zlib.crc32(chunk).to_bytes(4, "big")


def _after_jfif(content: bytes) -> int:
    """Return where the first segment of a JPEG file may stand: JFIF's own must be before it."""
    if content[_SOI_BYTES : _SOI_BYTES + 2] != _JFIF:
        return _SOI_BYTES
    return _SOI_BYTES + 2 + int.from_bytes(content[_SOI_BYTES + 2 : _SOI_BYTES + 4], "big")


def _matched(pattern: re.Pattern[bytes]) -> Callable[[bytes], int]:
    """Return what tells the end of something at the beginning of a file, which may be missing."""

    def end(content: bytes) -> int:
        found = pattern.match(content)
        return 0 if found is None else found.end()

    return end


PNG_TEXT = DigestMark(_png_chunk, lambda _: _IHDR_END)
"""A chunk ``tEXt`` behind the header."""
JPEG_COMMENT = DigestMark(lambda says: b"\xff\xfe" + (len(says) + 2).to_bytes(2, "big") + says, _after_jfif)
"""A segment ``COM``."""
TRAILER = DigestMark(lambda says: b"\n" + says + b"\n", len)
"""Behind the end, of TIFF and BMP files: both say where in them what stands, and nothing points there."""
PDF_COMMENT = DigestMark(lambda says: b"% " + says + b"\n", lambda content: content.rfind(b"startxref"))
"""A comment behind all that the file's table of places points to."""
XML_COMMENT = DigestMark(lambda says: b"<!-- " + says + b" -->\n", _matched(_XML_DECLARATION))
"""A comment behind the declaration, also in SVG."""
LINE_COMMENT = DigestMark(lambda says: b"# " + says + b"\n", _matched(_COMMENTS))
"""A line behind the first comments and directives, in YAML and ``.cameramodel``."""
TEXT_COMMENT = TextMark()
"""One of these two."""
VNL_COMMENT = DigestMark(lambda says: b"## " + says + b"\n", lambda _: 0)
"""The first line: with one ``#`` it would be the names of the columns."""
JSON_KEY = DigestMark(lambda says: b'"mark": "' + says + b'",\n  ', lambda content: content.find(b'"'))
"""The first key of an object."""
