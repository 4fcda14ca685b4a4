from pathlib import Path

import numpy as np
import pytest

from labcal.capture.addresses import KINDS, Address, named_addresses, parse_address, source_at
from labcal.capture.settings import SourceSettings
from labcal.capture.source import Source
from labcal.errors import InputError, UnknownNameError
from labcal.shoot.pictures import write_picture


def test_an_address_is_a_kind_and_a_place_with_the_cameras_name_before_it() -> None:
    assert parse_address("uvc:0") == Address("uvc", "0")
    assert parse_address("left=genicam:AB=12:3") == Address("genicam", "AB=12:3", "left")
    assert parse_address("folder:a=b") == Address("folder", "a=b")


@pytest.mark.parametrize("text", ["", "uvc", "uvc:", ":0", "le ft=uvc:0", "=uvc:0"])
def test_what_is_no_address_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(InputError, match="uvc:0"):
        parse_address(text)


def test_an_unknown_kind_is_answered_with_the_nearest_one() -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'genicam'"):
        parse_address("genican:1")


def test_several_sources_get_names_and_no_two_are_the_same() -> None:
    assert [one.camera for one in named_addresses(["uvc:0", "right=uvc:1"])] == ["camera-1", "right"]
    for twice in (["uvc:0", "uvc:0"], ["a=uvc:0", "a=uvc:1"], ["a=uvc:0", "A=uvc:1"]):
        with pytest.raises(InputError):
            named_addresses(twice)
    with pytest.raises(InputError, match="No source"):
        named_addresses([])


def test_every_kind_has_a_source() -> None:
    places = {"sim": "webcam-plane"}
    for kind in KINDS:
        source = source_at(Address(kind, places.get(kind, "0")), SourceSettings())
        assert isinstance(source, Source), kind
        source.close()  # one that was never opened


def test_a_folder_of_two_cameras_is_never_taken_for_one(tmp_path: Path) -> None:
    for name in ("a_0.png", "a_1.png"):
        write_picture(tmp_path / name, np.zeros((24, 32), np.uint8))
    settings = SourceSettings(cameras="_0=left,_1=right")
    alone = source_at(Address("folder", str(tmp_path)), settings)
    alone.open()
    assert [one.name for one in alone.describe()] == ["left", "right"]
    with pytest.raises(InputError, match="left, right"):
        source_at(Address("folder", str(tmp_path), "both"), settings).open()


def test_a_folder_that_may_be_of_two_cameras_is_asked_about(tmp_path: Path) -> None:
    for number in (*range(31, 35), *range(977, 981)):
        write_picture(tmp_path / f"GOPR{number:04d}.png", np.zeros((24, 32), np.uint8))
    with pytest.raises(InputError, match="taken as of one camera, but their numbers are in 2 rows far apart"):
        source_at(Address("folder", str(tmp_path)), SourceSettings()).open()
    for source in (
        source_at(Address("folder", str(tmp_path)), SourceSettings(cameras="*=camera")),
        source_at(Address("folder", str(tmp_path), "left"), SourceSettings()),
    ):
        source.open()
        assert len(source.describe()) == 1
