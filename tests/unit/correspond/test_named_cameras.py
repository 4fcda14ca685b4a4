import itertools
import re
from pathlib import Path

import pytest

from labcal.correspond.name_patterns import view_in
from labcal.correspond.named_cameras import named_cameras
from labcal.correspond.one_camera import doubts
from labcal.correspond.picture_set import open_pictures
from labcal.correspond.sources import loose_source, loose_sources, parse_camera_endings
from labcal.errors import InputError


def crossed(pattern: str, cameras: tuple[str, ...], views: int = 6) -> list[str]:
    return [pattern.format(c=camera, n=view) for view, camera in itertools.product(range(views), cameras)]


PAIRED = {
    "folders": (crossed("{c}/{n:02d}.png", ("LEFT", "RIGHT")), "LEFT/*=left,RIGHT/*=right"),
    "prefixes": (crossed("{c}{n:02d}.png", ("left", "right")), "left*=left,right*=right"),
    "infix": (
        crossed("shot_{n:02d}_{c}_x.png", ("camA", "camB")),
        "shot_*_camA_x=camA,shot_*_camB_x=camB",
    ),
    "hyphen": (crossed("{n:02d}-cam{c}.png", ("0", "1")), "-cam0=cam0,-cam1=cam1"),
    "endings": (crossed("CalB-sys2-{n:04d}_{c}.jpeg", ("0", "1")), "_0=cam0,_1=cam1"),
    "three": (crossed("view{n}_cam{c}.png", ("0", "1", "2")), "_cam0=cam0,_cam1=cam1,_cam2=cam2"),
    "letters": (crossed("{n:03d}{c}.png", ("L", "R")), "L=left,R=right"),
    "serials": (
        crossed("{c}_{n:04d}.tif", ("22534567", "22534571")),
        "22534567_*=cam22534567,22534571_*=cam22534571",
    ),
    "serials of hexadecimal digits": (
        crossed("DEV_{c}_{n:03d}.png", ("000F314B1E58", "000F314B1E5A")),
        "DEV_000F314B1E58_*=000F314B1E58,DEV_000F314B1E5A_*=000F314B1E5A",
    ),
    "twelve": (
        crossed("cam{c}_{n:02d}.png", tuple(str(number) for number in range(1, 13)), 4),
        ",".join(f"cam{number}_*=cam{number}" for number in range(1, 13)),
    ),
    "folder and name": (
        [f"{side}/{side}{n:02d}.png" for side in ("left", "right") for n in range(5)],
        "left/left*=left,right/right*=right",
    ),
    "folders below": (crossed("{c}/data/{n}.png", ("cam0", "cam1")), "cam0/*=cam0,cam1/*=cam1"),
    "a folder a view": (crossed("scene{n}/im{c}.png", ("0", "1")), "*/im0=cam0,*/im1=cam1"),
    "more cameras than poses": (
        crossed("pose{n}/c{c}.png", ("1", "2", "3", "4"), 3),
        "*/c1=cam1,*/c2=cam2,*/c3=cam3,*/c4=cam4",
    ),
    "more cameras than poses, told twice": (
        [f"pose_{n}/pose_{n}_{c}.png" for n in range(3) for c in "ABCD"],
        "_A=A,_B=B,_C=C,_D=D",
    ),
    "more cameras than views": (
        crossed("view{n}_{c}.png", tuple("01234"), 3),
        ",".join(f"_{n}=cam{n}" for n in range(5)),
    ),
    "twelve in many views": (
        crossed("view{n:02d}_{c}.png", tuple(str(number) for number in range(1, 13)), 12),
        ",".join(f"_{number}=cam{number}" for number in range(1, 13)),
    ),
    "words": (crossed("{c}_{n:04d}.png", ("master", "slave")), "master_*=master,slave_*=slave"),
    "one of a word lost": (crossed("{c}_{n}.png", ("vis", "nir"))[:-1], "nir_*=nir,vis_*=vis"),
    "one in a folder lost": (crossed("{c}/{n}.png", ("front", "back"))[:-1], "back/*=back,front/*=front"),
    "as many views": (
        crossed("{c}/{n:04d}.png", ("1", "2", "3", "4"), 4),
        "1/*=cam1,2/*=cam2,3/*=cam3,4/*=cam4",
    ),
    "one picture lost": (crossed("{n:04d}_{c}.png", ("0", "1"))[:-1], "_0=cam0,_1=cam1"),
    "a glued digit at the end": (crossed("{n}{c}.png", ("1", "2"), 8), "1=cam1,2=cam2"),
    "a glued digit in front": (crossed("cam{c}{n:02d}.png", ("0", "1"), 8), "cam0*=cam0,cam1*=cam1"),
    "a glued digit within": (crossed("shot{n:02d}{c}_x.png", ("0", "1")), "shot*0_x=cam0,shot*1_x=cam1"),
    "three glued digits": (crossed("c{c}{n:02d}.png", ("1", "2", "3")), "c1*=cam1,c2*=cam2,c3*=cam3"),
    "folders without letters": (crossed("{c}/{n:02d}.png", ("左", "右")), "右/*=cam1,左/*=cam2"),
    "stamps and a digit": (
        crossed("17000000{n:02d}123_{c}.png", ("0", "1")),
        "_0=cam0,_1=cam1",
    ),
    "right ones lost": (crossed("{c}{n:02d}.png", ("left", "right"))[:-3], "left*=left,right*=right"),
}

ONE_CAMERA = {
    "a digital camera's": [f"IMG_{n}.JPG" for n in range(2034, 2046)],
    "counted": [f"img_{n:04d}.png" for n in range(1, 13)],
    "frames": [f"frame-{n:03d}.png" for n in range(12)],
    "without a sign": [f"DSC0{n:04d}.JPG" for n in range(98, 107)],
    "moments": [f"2026-11-26_10{n:02d}{7 * n % 60:02d}.png" for n in range(12)],
    "every half minute": [f"2026-11-26_10-{n // 2:02d}-{30 * (n % 2):02d}.png" for n in range(12)],
    "Windows": [f"WIN_20261126_10_{n // 2:02d}_{30 * (n % 2):02d}_Pro.jpg" for n in range(12)],
    "clock": [f"10-1{m}-{s:02d}.png" for m in range(3) for s in (0, 30)],
    "two pictures": ["view1.png", "view2.png"],
    "two endings": ["a_0.jpeg", "a_1.jpeg"],
    "white": [f"white_dot_{n:02d}.jpeg" for n in range(5)],
    "one of a pair": [f"dot_{n:02d}_0.png" for n in range(10)],
    "left alone": [f"left{n:02d}.png" for n in range(6)],
    "camera and a count": [f"camera_{n:03d}.png" for n in range(12)],
    "serial and count": [f"acA1920__22534567__1015{n:02d}123_{n:04d}.tiff" for n in range(9)],
    "places": ["left.png", "right.png", "top.png", "middle.png"],
    "stage": [f"x{a}_y{b}.png" for a in range(3) for b in range(3)],
    "tilts": [f"tilt{a}_pan{b}.png" for a in (0, 15, 30) for b in (0, 15)],
    "exposures": [f"view{a}_{b}us.png" for a in range(5) for b in (100, 200)],
    "days": [f"day{1 + n // 6}/{n:03d}.png" for n in range(12)],
    "edited": ["IMG_2034.JPG", "IMG_E2034.JPG", "IMG_2035.JPG", "IMG_E2035.JPG"],
    "copies": ["a.png", "a (1).png", "a (2).png"],
    "near and far": [*(f"near{n}.png" for n in range(4)), *(f"far{n}.png" for n in range(3))],
    "milliseconds": [f"{1732615200123 + 517 * n}.png" for n in range(9)],
    "odd paths": ["/", "", ".", "..", "a" * 5000, "7" * 5000, f"{'7' * 5000}_2", "7_1"],
    "hundreds": [f"{n}.png" for n in range(100, 300)],
    "every fifth": [f"frame{n:04d}.png" for n in range(0, 200, 5)],
    "rows and columns": [f"{row}{col}.png" for row in (1, 2, 3) for col in range(1, 9)],
    "nights": [f"2026050{3 + n // 5}_{1400 + 7 * n}.png" for n in range(10)],
    "none": [],
}

IN_ORDER = {
    "serials and moments": (
        "Basler_{c}_20260503_14{n:02d}{m:03d}.tiff",
        ("23751808", "23751811"),
        "cam23751808=DIR/Basler_23751808_20260503_*.tiff,cam23751811=DIR/Basler_23751811_20260503_*.tiff",
    ),
    "sides and moments": (
        "{c}_14{n:02d}{m:03d}.png",
        ("left", "right"),
        "left=DIR/left_*.png,right=DIR/right_*.png",
    ),
    "digits and moments": ("14{n:02d}{m:03d}_{c}.png", ("1", "2"), "cam1=DIR/*_1.png,cam2=DIR/*_2.png"),
    "words and moments": ("{c}-14{n:02d}{m:03d}.png", ("low", "top"), "low=DIR/low-*.png,top=DIR/top-*.png"),
    "folders and moments": (
        "{c}/data/14{n:02d}{m:03d}.png",
        ("cam0", "cam1"),
        "cam0=DIR/cam0/data/,cam1=DIR/cam1/data/",
    ),
    "sides that count on": ("{c}/DSC_{k:04d}.JPG", ("left", "right"), "left=DIR/left/,right=DIR/right/"),
}


@pytest.mark.parametrize("names", IN_ORDER)
def test_pictures_of_unlike_moments_pair_up_in_their_order(names: str, tmp_path: Path) -> None:
    pattern, cameras, option = IN_ORDER[names]
    for index, (camera, view) in enumerate(itertools.product(cameras, range(6))):
        moment = 100 + (37 * index) % 40
        path = tmp_path / pattern.format(c=camera, n=2 * view, m=moment, k=230 + 9 * index)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    option = option.replace("DIR", str(tmp_path))
    with pytest.raises(InputError, match=re.escape(f"`cameras='{option}'`")):
        open_pictures(tmp_path)
    sources = open_pictures(tmp_path, option).sources
    assert len({source.view for source in sources}) == 6
    assert len({source.camera for source in sources}) == 2
    assert all(len(list(two)) == 2 for _, two in itertools.groupby(sources, lambda one: one.view))


DOUBTED = {
    "two in one folder": [f"GOPR{n:04d}.JPG" for n in (*range(31, 38), *range(977, 984))],
    "one picture lost": [f"GOPR{n:04d}.JPG" for n in (*range(31, 38), *range(977, 980), *range(981, 985))],
    "two kinds of names": [
        f"{kind}{n:05d}.JPG" for kind in ("IMG_", "DSC") for n in range(31, 36 + len(kind))
    ],
    "folders that count on": [f"GoPro{n // 7}/GX{31 + n + 900 * (n // 7)}.JPG" for n in range(14)],
    "folders of unlike counts": [f"{'ab'[n > 5]}/{31 + n + 900 * (n > 5)}.JPG" for n in range(14)],
}


@pytest.mark.parametrize("names", DOUBTED)
def test_what_is_taken_as_one_camera_in_doubt_is_said(names: str, tmp_path: Path) -> None:
    for name in DOUBTED[names]:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    opened = open_pictures(tmp_path)
    (warning,) = opened.warnings
    assert warning.startswith(f"{len(opened.sources)} pictures are taken as of one camera")
    assert open_pictures(tmp_path, "*=camera").warnings == ()


@pytest.mark.parametrize("names", [name for name in ONE_CAMERA if name not in ("odd paths", "near and far")])
def test_pictures_of_one_camera_raise_no_doubt(names: str) -> None:
    assert doubts(ONE_CAMERA[names]) is None


def test_numbers_of_any_length_are_names() -> None:
    long = "7" * 5000
    assert named_cameras([f"{long}{view}{camera}.png" for view in range(8) for camera in (1, 2)]) is None
    assert named_cameras([f"{camera}{long}_{view}.png" for view in range(8) for camera in (1, 2)]) is not None


def test_frames_are_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    for camera, start in (("a", 95), ("b", 3)):
        (tmp_path / camera).mkdir()
        for n in range(8):
            (tmp_path / camera / f"frame{start + n}.png").touch()
    sources = open_pictures(tmp_path, f"a={tmp_path}/a/,b={tmp_path}/b/").sources
    pairs = [
        (Path(one.image).stem, Path(two.image).stem)
        for one, two in zip(sources[::2], sources[1::2], strict=True)
    ]
    assert pairs == [(f"frame{95 + n}", f"frame{3 + n}") for n in range(8)]


def test_one_view_in_folders_of_cameras_is_told(tmp_path: Path) -> None:
    for camera in ("left", "right"):
        (tmp_path / camera).mkdir()
        (tmp_path / camera / "0.png").touch()
    with pytest.raises(InputError, match=re.escape("`cameras='left/*=left,right/*=right'`")):
        open_pictures(tmp_path)


@pytest.mark.parametrize("names", PAIRED)
def test_pictures_of_several_cameras_are_not_taken_for_one(names: str) -> None:
    images, option = PAIRED[names]
    told = named_cameras(images)
    assert told is not None
    assert told.option == option
    assert f"`cameras='{option}'`" in told.words()
    endings = parse_camera_endings(option)
    sources = [loose_source(image, endings) for image in images]  # what is said to be typed works
    assert len({source.camera for source in sources}) == len(endings)
    assert len({(source.view, source.camera) for source in sources}) == len(images)
    assert len({source.view for source in sources}) == -(-len(images) // len(endings)) or "lost" in names


@pytest.mark.parametrize("names", ONE_CAMERA)
def test_pictures_of_one_camera_are_accused_of_nothing(names: str) -> None:
    assert named_cameras(ONE_CAMERA[names]) is None


def test_a_pair_without_a_name_for_the_view_is_told_to_get_one() -> None:
    told = named_cameras(["left.png", "right.png"])
    assert told is not None
    assert told.option is None
    assert "left1.png and right1.png" in told.words()


def test_patterns_tell_the_view() -> None:
    assert view_in("home/LEFT/00.png", "LEFT/*") == "00"
    assert view_in("home/LEFT/deep/00.png", "LEFT/*") == "deep-00"
    assert view_in("home/NOTLEFT/00.png", "LEFT/*") is None
    assert view_in("shot_07_camA_x.png", "*_camA_*") == "shot_07-x"
    assert view_in("left07.png", "left*") == "07"
    assert view_in("left.png", "left*") is None  # nothing is left for the view
    assert view_in("a.b_1.png", "*") == "a.b_1"


def test_loose_pictures_are_refused_until_somebody_says(tmp_path: Path) -> None:
    home = tmp_path / "photos"
    for image in PAIRED["folders"][0]:
        (home / image).parent.mkdir(parents=True, exist_ok=True)
        (home / image).write_bytes(b"x")
    for given in ([home], [home / "LEFT", home / "RIGHT"]):
        paths = [str(path) for path in given]
        with pytest.raises(InputError, match=r"2 cameras .*`cameras='LEFT/\*=left,RIGHT/\*=right'"):
            loose_sources(paths, {})
        found = loose_sources(paths, {"LEFT/*": "left", "RIGHT/*": "right"})
        assert [(source.view, source.camera) for source in found[:2]] == [("00", "left"), ("00", "right")]
        assert len(found) == 12
    alone = loose_sources([str(home / "LEFT")], {})  # one folder is one camera
    assert {source.camera for source in alone} == {"camera"}
    for image in PAIRED["prefixes"][0]:
        (tmp_path / image).write_bytes(b"x")
    one = loose_sources([str(tmp_path)], parse_camera_endings("*=camera"))
    assert [source.view for source in one[:2]] == ["left00", "left01"]
    assert {source.camera for source in one} == {"camera"}


def test_a_named_camera_at_the_end_needs_no_view() -> None:
    assert parse_camera_endings("-cam{camera}") == {"{view}-cam{camera}": "{camera}"}
    sources = loose_sources_of(["00-camA.png", "00-camB.png"], "-cam{camera}")
    assert sources == [("00", "A"), ("00", "B")]


def loose_sources_of(images: list[str], cameras: str) -> list[tuple[str, str]]:
    found = [loose_source(image, parse_camera_endings(cameras)) for image in images]
    return [(source.view, source.camera) for source in found]


def test_one_picture_in_two_formats_is_told(tmp_path: Path) -> None:
    for name in ("IMG_01.jpg", "IMG_01.tif"):
        (tmp_path / name).touch()
    with pytest.raises(InputError, match=r"two formats, give those of one.*\*\.tif"):
        loose_sources([str(tmp_path)], {})


@pytest.mark.parametrize(
    ("images", "option"),
    [
        (
            [f"Nikon/DSC_{n:04d}.jpg" for n in range(5)] + [f"Canon/IMG_{7 + n:04d}.jpg" for n in range(5)],
            "Nikon=Nikon/,Canon=Canon/",
        ),
        (
            [f"cam_{c}/{1700000000123 + 1000 * n + 17 * (c == 'b')}.png" for c in "ab" for n in range(5)],
            "cam-a=cam_a/,cam-b=cam_b/",
        ),
        ([f"a=1/DSC_{n}.png" for n in range(4)] + [f"a=2/IMG_{n + 9}.png" for n in range(4)], None),
    ],
)
def test_folders_of_as_many_pictures_pair_up_in_their_order(images: list[str], option: str | None) -> None:
    told = named_cameras(images)
    assert told is not None
    assert told.option == option
    assert len(told.pictures) == 2


def test_days_of_one_camera_count_on() -> None:
    for start in (6, 40):
        assert named_cameras([f"day{1 + n // 6}/v{n + start * (n // 6)}.png" for n in range(12)]) is None
