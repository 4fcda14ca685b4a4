"""Addresses of sources: ``KIND:PLACE``, with the name of the camera before it where there are several."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module

from labcal.capture.settings import SourceSettings
from labcal.capture.source import Source
from labcal.errors import InputError, UnknownNameError
from labcal.run.names import differ_in_case, is_name
from labcal.wording import clipped, listed


@dataclass(frozen=True)
class SourceKind:
    """A kind of source."""

    name: str
    """Word before the colon."""
    place: str
    """The words after it, as help writes them."""
    does: str
    """Description for help, a noun phrase."""
    module: str
    """Module that has the function `source_of`."""


KINDS: Mapping[str, SourceKind] = {
    kind.name: kind
    for kind in (
        SourceKind("sim", "SCENE", "the cameras of a scene, rendered", "simulated"),
        SourceKind("folder", "PATH", "pictures that are there already, in order", "folder"),
        SourceKind("watch", "PATH", "a folder into which another program drops pictures", "watch"),
        SourceKind(
            "video",
            "PATH",
            "a video file, several of which are put in time by the motion of the target",
            "video",
        ),
        SourceKind("uvc", "NUMBER", "a webcam, by its number, 0 the first", "uvc"),
        SourceKind(
            "genicam",
            "SERIAL",
            "a GigE Vision or USB3 Vision camera, by serial number, name or IP address",
            "genicam",
        ),
    )
}
"""Kinds of sources by name: one module each."""


@dataclass(frozen=True)
class Address:
    """The address of a source."""

    kind: str
    """One of :data:`KINDS`."""
    place: str
    """Scene, path, number or serial number."""
    camera: str | None = None
    """Name of its camera, where given."""

    def __str__(self) -> str:
        """Return the address without the camera's name."""
        return f"{self.kind}:{self.place}"


def parse_address(text: str) -> Address:
    """Return an address from text such as ``genicam:02-1234`` or ``left=uvc:0``.

    Raises
    ------
    InputError
        The text is no address, or the camera's name is no name.
    UnknownNameError
        There is no such kind of source.
    """
    kind, colon, place = text.partition(":")
    camera, equals, rest = kind.rpartition("=")
    kind = rest if equals else kind
    if not (colon and place and kind) or (equals and not is_name(camera)):
        raise InputError(
            f"'{clipped(text)}' is no address of a source. Write KIND:PLACE, such as uvc:0 or "
            "sim:webcam-plane, or NAME=KIND:PLACE with a camera's name of letters, digits and hyphens, as in "
            f"left=uvc:0. Kinds: {listed(list(KINDS))}."
        )
    if kind not in KINDS:
        raise UnknownNameError("kind of source", kind, KINDS)
    return Address(kind, place, camera or None)


def named_addresses(texts: Sequence[str]) -> list[Address]:
    """Return addresses whose cameras have different names: those given, else ``camera-1``, ``camera-2``.

    A single source keeps the names that it has itself.

    Raises
    ------
    InputError
        None is given, one is no address, or two are the same or have the same name.
    """
    addresses = [parse_address(text) for text in texts]
    if not addresses:
        raise InputError("No source is given. Give one or more, such as uvc:0 or sim:webcam-plane.")
    if len(addresses) == 1:
        return addresses
    named = [
        Address(one.kind, one.place, one.camera or f"camera-{number}")
        for number, one in enumerate(addresses, start=1)
    ]
    for seen in ([str(one) for one in named], [str(one.camera) for one in named]):
        twice = next((one for one in seen if seen.count(one) > 1), None)
        if twice is not None:
            raise InputError(f"'{clipped(twice)}' is given twice. Give each source, and each name, once.")
    alike = differ_in_case(str(one.camera) for one in named)
    if alike is not None:
        raise InputError(f"The cameras '{alike[0]}' and '{alike[1]}' differ only in capital letters.")
    return named


def source_at(address: Address, settings: SourceSettings) -> Source:
    """Return the source at an address, not opened yet.

    Raises
    ------
    InputError
        Its kind cannot use the place or a setting.
    """
    module = import_module(f"labcal.capture.{KINDS[address.kind].module}")
    make: Callable[[Address, SourceSettings], Source] = module.source_of
    return make(address, settings)
