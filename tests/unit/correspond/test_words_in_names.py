"""What words and numbers in names of pictures tell: cameras, series of one camera, or neither for sure."""

import itertools
import unicodedata
from collections.abc import Iterable

import pytest

from labcal.correspond.named_cameras import named_cameras
from labcal.correspond.one_camera import doubts
from labcal.correspond.sources import loose_source, parse_camera_endings


def crossed(pattern: str, cameras: Iterable[object], views: Iterable[object]) -> list[str]:
    return [pattern.format(c=camera, n=view) for view, camera in itertools.product(views, cameras)]


EIGHT, SERIALS = range(8), range(22005000, 22005010)
MANY = [
    *(
        (crossed(f"{word}{{c}}_{{n:03d}}.png", numbers, EIGHT), 2)
        for word, numbers in (
            ("video", (0, 2)),
            ("webcam", (0, 2)),
            ("kinect", (2, 3)),
            ("rpi", (4, 5)),
            ("pi-", (11, 12)),
            ("node", (7, 9)),
            ("gopro", (9, 10)),
            ("ch", (3, 5)),
            ("dev", (2, 4)),
            ("usb", (1, 3)),
            ("cámara", (2, 3)),
            (unicodedata.normalize("NFD", "cámara"), (2, 3)),
            ("caméra", (2, 3)),
            ("câmera", (4, 7)),
            ("telecamera", (2, 3)),
            ("kam", (2, 3)),
            ("Камера", (2, 3)),
            ("相机", (2, 3)),
            ("myUsbCam", (5, 6)),
        )
    ),
    (crossed("frame{n:03d}_video{c}.png", (0, 2), EIGHT), 2),
    (crossed("video{c}_{n}.png", (0, 2), EIGHT)[:-1], 2),  # one is lost
    (crossed("192.168.0.{c}_{n:03d}.png", (10, 11), EIGHT), 2),
    (crossed("cam-192-168-0-{c}_{n:03d}.png", (10, 11), EIGHT), 2),
    (crossed("{c}_{n:04d}.png", SERIALS, range(12)), 10),
    (crossed("{n:04d}_{c}.png", SERIALS, range(10)), 10),
    (crossed("{c}_{n:04d}.png", SERIALS, range(5)), 10),  # fewer views than cameras
    (crossed("{c}/{n:04d}.png", SERIALS, range(12)), 10),
    (crossed("{c}/{n:04d}.png", range(22005000, 22005012), range(2)), 12),
    (crossed("image_{c:02d}/data/{n:010d}.png", (2, 3), EIGHT), 2),  # KITTI
    ([f"2024-03-{d}/{s}_{n}.png" for d in (12, 13) for s in (22005000, 22005001) for n in EIGHT], 2),
    ([f"set{d}_{n}_{c}.png" for d in (1, 2, 3) for c in (0, 1) for n in EIGHT], 2),
    (crossed("vue{n}_{c}.png", range(5), range(3)), 5),  # more cameras than placements
    (crossed("position_{n}/{c}.png", range(5), range(3)), 5),
]
DATES = (20240312, 20240313)
ONE = [
    *(
        crossed(f"{word}{{c}}_{{n}}.png", values, range(1, 9))
        for word, values in itertools.product(
            (
                "set", "session", "run", "exp", "day", "take", "height", "tilt_", "z", "focus", "iso",
                "burst", "step", "series-", "calibSet", "Tag", "sesión", "Höhe", "messung",
            ),
            ((1, 2), (300, 400, 500)),
        )
    ),
    crossed("tilt_{c}_{n}.png", range(3), range(4)),
    crossed("p{n}_exp{c}.png", (1, 2, 3), range(6)),
    crossed("pose{n}_focus{c}.png", range(3), range(5)),
    crossed("{n:03d}_ev{c}.jpg", (1, 2, 3), EIGHT),
    crossed("pose{n}_{c}us.png", (10000, 20000), EIGHT),
    crossed("{c}mm_{n}.png", (500, 750, 1000), EIGHT),
    crossed("T{c}C_{n}.png", (20, 30, 40), EIGHT),
    crossed("2024-03-{c}_{n}.png", (12, 13), EIGHT),
    crossed("{c:02d}.03.2024_{n}.png", (1, 2), EIGHT),
    crossed("20240312_{c}_{n}.png", (101200, 103000), EIGHT),
    crossed("IMG_20240312_{c}_BURST{n:03d}.jpg", (101112, 101140), EIGHT),
    crossed("camera_{c}us_{n}.png", (1000, 2000), EIGHT),
    crossed("sensor_{c}C_{n}.png", (20, 30), EIGHT),
    crossed("video2_{n:04d}.png", (0,), range(0, 60, 5)),
    crossed("usb_{n:04d}.png", (0,), range(12)),
]  # fmt: skip
DAYS = [
    crossed(form, values, range(1, 7))
    for form, values in (
        ("day{c}/{n}.jpg", (1, 2)),
        ("set{c}/{n}.jpg", (1, 2, 3)),
        ("cam0_session{c}/{n}.jpg", (1, 2)),
        ("2024-03-{c}/{n}.jpg", (12, 13)),
        ("calib_{c}/{n}.jpg", DATES),
        ("{c}.03.2024/{n}.jpg", (12, 13)),
        ("{c}mm/{n}.jpg", (300, 400)),
        ("{c}/{n}.jpg", (2023, 2024)),
    )
]
"""Folders of one camera, whose pictures have equal names."""
UNSURE = [
    (crossed("{c}_{n:03d}.png", (4103, 4104), EIGHT), 2),
    (crossed("{n:03d}_{c}.png", (4103, 4104), EIGHT), 2),
    (crossed("{c}_{n:03d}.png", (4103, 4104), EIGHT)[:-1], 2),  # one is lost
    (crossed("{n:02d}_Nr{c}.png", (3, 4), EIGHT), 2),
    (crossed("c{c:02d}_{n:04d}.png", range(16), range(17)), 16),
    (crossed("C{c}_{n}.png", (4, 7), EIGHT), 2),
    (crossed("{c}c_{n}.png", (2, 3), EIGHT), 2),
    (crossed("{c}_{n}.png", DATES, EIGHT), 2),
    (crossed("camera_{c}_{n}.png", DATES, EIGHT), 2),
    (crossed("{n}_{c}.png", ("12032024", "13032024"), EIGHT), 2),
    (crossed("r{n}_c{c}.png", range(4), range(5)), 4),
    (crossed("shot{n}_{c}.png", range(5), range(3)), 5),
    (crossed("pose{n}_{c}.png", (10000, 20000, 50000), EIGHT), 3),
    (crossed("{c}_{n}.png", range(10), range(12)), 10),
]


def works(images: list[str], option: str, cameras: int) -> bool:
    """Tell whether what is said to be typed distinguishes as many cameras, each picture as one view."""
    endings = parse_camera_endings(option)
    sources = [loose_source(image, endings) for image in images]
    every = {(source.camera, source.view) for source in sources}
    return len({source.camera for source in sources}) == cameras and len(every) == len(images)


@pytest.mark.parametrize(
    ("images", "cameras"), MANY, ids=lambda one: str(one[0] if isinstance(one, list) else one)
)
def test_numbers_of_devices_are_those_of_cameras(images: list[str], cameras: int) -> None:
    told = named_cameras(images)
    assert told is not None
    assert len(told.pictures) == cameras
    assert told.option is not None
    assert works(images, told.option, cameras)
    assert works(images, f"{told.alone}=camera", 1)


@pytest.mark.parametrize("images", ONE, ids=lambda images: images[0])
def test_series_of_one_camera_are_accused_of_nothing(images: list[str]) -> None:
    assert named_cameras(images) is None
    assert doubts(images) is None


@pytest.mark.parametrize("images", DAYS, ids=lambda images: images[0])
def test_folders_of_days_and_series_are_not_those_of_cameras(images: list[str]) -> None:
    assert named_cameras(images) is None


@pytest.mark.parametrize(
    ("images", "cameras"), UNSURE, ids=lambda one: str(one[0] if isinstance(one, list) else one)
)
def test_numbers_with_every_view_that_may_be_anything_are_doubted(images: list[str], cameras: int) -> None:
    assert named_cameras(images) is None
    doubt = doubts(images)
    assert doubt is not None
    assert works(images, doubt.split("`cameras='")[1].split("'`")[0], cameras)
