"""Marks in single files, by which labcal recognises its own files and sees whether they were changed.

A mark is a comment, or the like in that format, and holds the SHA-256 of the rest of the file. Readers of the
format ignore it. Formats of labcal's own need no mark: their first bytes identify them.
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
    """The result of the check of a file's mark."""

    AS_WRITTEN = "labcal wrote it so"
    CHANGED = "labcal wrote it, but it has been changed since"
    UNMARKED = "labcal did not write it, or a version without marks"


@dataclass(frozen=True)
class DigestMark:
    """A mark for formats that other programs write, too."""

    block: Callable[[bytes], bytes]
    """A function from the text of the mark to the bytes that hold it in the file."""
    place: Callable[[bytes], int]
    """A function from the content without a mark to the position at which these bytes are inserted."""

    def put(self, content: bytes) -> bytes:
        """Return a file's content with the mark."""
        at = self.place(content)
        return content[:at] + self._piece(content) + content[at:]

    def judge(self, content: bytes) -> Judgement:
        """Return the judgement of a file, from its whole content."""
        found = _MARK.search(content)
        if found is None:
            return Judgement.UNMARKED
        rest = content.replace(self.block(found[0]), b"", 1)
        return Judgement.AS_WRITTEN if self.put(rest) == content else Judgement.CHANGED

    def _piece(self, content: bytes) -> bytes:
        return self.block(_SAYS + hashlib.sha256(content).hexdigest().encode())


@dataclass(frozen=True)
class FormatMark:
    """The mark of a format that only labcal writes: the format itself."""

    is_of_format: Callable[[bytes], bool]
    """A function that tells from a file's content whether it is of the format."""

    def put(self, content: bytes) -> bytes:
        """Return the content as it is."""
        return content

    def judge(self, content: bytes) -> Judgement:
        """Return the judgement of a file: whether it is of the format."""
        return Judgement.AS_WRITTEN if self.is_of_format(content) else Judgement.UNMARKED


class TextMark:
    """A comment in a text: an XML comment if the text begins like XML, else a comment line."""

    def put(self, content: bytes) -> bytes:
        """Return a file's content with the mark."""
        return self._mark(content).put(content)

    def judge(self, content: bytes) -> Judgement:
        """Return the judgement of a file, from its whole content."""
        return self._mark(content).judge(content)

    def _mark(self, content: bytes) -> DigestMark:
        return XML_COMMENT if content.startswith(b"<") else LINE_COMMENT


FileMark = DigestMark | TextMark | FormatMark
"""The kinds of marks, by which files that labcal wrote are distinguished from others."""


def _png_chunk(text: bytes) -> bytes:
    """Return a PNG text chunk with the keyword of the program that made the picture."""
    chunk = b"tEXt" + b"Software\0" + text
    return (len(chunk) - 4).to_bytes(4, "big") + chunk + zlib.crc32(chunk).to_bytes(4, "big")


def _after_jfif(content: bytes) -> int:
    """Return the position of the first segment of a JPEG file behind JFIF's own, which must come first."""
    if content[_SOI_BYTES : _SOI_BYTES + 2] != _JFIF:
        return _SOI_BYTES
    return _SOI_BYTES + 2 + int.from_bytes(content[_SOI_BYTES + 2 : _SOI_BYTES + 4], "big")


def _matched(pattern: re.Pattern[bytes]) -> Callable[[bytes], int]:
    """Return a function that finds the end of an optional pattern at the beginning of a file."""

    def end(content: bytes) -> int:
        found = pattern.match(content)
        return 0 if found is None else found.end()

    return end


PNG_TEXT = DigestMark(_png_chunk, lambda _: _IHDR_END)
"""A chunk ``tEXt`` behind the header."""
JPEG_COMMENT = DigestMark(lambda text: b"\xff\xfe" + (len(text) + 2).to_bytes(2, "big") + text, _after_jfif)
"""A segment ``COM``."""
TRAILER = DigestMark(lambda text: b"\n" + text + b"\n", len)
"""Bytes behind the end, for TIFF and BMP, in which nothing refers to that position."""
PDF_COMMENT = DigestMark(lambda text: b"% " + text + b"\n", lambda content: content.rfind(b"startxref"))
"""A comment behind everything that the file's cross-reference table points to."""
XML_COMMENT = DigestMark(lambda text: b"<!-- " + text + b" -->\n", _matched(_XML_DECLARATION))
"""A comment behind the declaration, also in SVG."""
HTML_COMMENT = DigestMark(lambda text: b"<!-- " + text + b" -->\n", len)
"""A comment behind the end of a page."""
LINE_COMMENT = DigestMark(lambda text: b"# " + text + b"\n", _matched(_COMMENTS))
"""A line behind the first comments and directives, in YAML and ``.cameramodel``."""
TEXT_COMMENT = TextMark()
"""One of these two."""
VNL_COMMENT = DigestMark(lambda text: b"## " + text + b"\n", lambda _: 0)
"""The first line: with one ``#`` it would be the names of the columns."""
PLY_COMMENT = DigestMark(lambda text: b"comment " + text + b"\n", lambda content: content.find(b"element "))
"""A comment of the header, before the elements."""
JSON_KEY = DigestMark(lambda text: b'"mark": "' + text + b'",\n  ', lambda content: content.find(b'"'))
"""The first key of an object."""
