"""Advice about cameras is tried as it is printed: what is typed works for the very pictures."""

import re
from pathlib import Path

import pytest

from labcal.correspond.picture_set import PictureSet, open_pictures
from labcal.errors import InputError

ADVICE = re.compile(r"`cameras='([^`]*)'`")


def laid_out(names: list[str], home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(home)
    for name in names:
        path = Path("photos") / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()


def cameras_of(pictures: PictureSet) -> dict[str, int]:
    found = [source.camera for source in pictures.sources]
    return {camera: found.count(camera) for camera in sorted(set(found))}


SIDES = [f"{side}/{n}.png" for side in ("LEFT", "RIGHT") for n in range(3)]
CAMS = [f"cam{c}_{n}.png" for c in (1, 2) for n in range(3)]
INSIDE = [f"{n}_{side}_cam.png" for side in ("left", "right") for n in range(3)]
TYPED = [
    (CAMS, "cam1=left,cam2=right", "cam1*=left,cam2*=right"),
    (CAMS, "CAM1*=left,CAM2*=right", "cam1*=left,cam2*=right"),
    (CAMS, "left=cam1,right=cam2", "cam1*=left,cam2*=right"),
    (SIDES, "LEFT=left,RIGHT=right", "LEFT/*=left,RIGHT/*=right"),
    (SIDES, "left=LEFT,right=RIGHT", "LEFT/*=left,RIGHT/*=right"),
    (SIDES, "LEFT/=left,RIGHT/=right", "LEFT/*=left,RIGHT/*=right"),
    (INSIDE, "_left=left,_right=right", "*_left*=left,*_right*=right"),
]


@pytest.mark.parametrize(("names", "typed", "meant"), TYPED)
def test_endings_that_fit_nothing_are_answered_with_what_is_meant(
    names: list[str], typed: str, meant: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    laid_out(names, tmp_path, monkeypatch)
    with pytest.raises(InputError) as error:
        open_pictures("photos", typed)
    assert ADVICE.findall(str(error.value)) == [meant]
    assert cameras_of(open_pictures("photos", meant)) == {"left": 3, "right": 3}


def test_what_cannot_be_guessed_is_explained(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    laid_out(CAMS, tmp_path, monkeypatch)
    with pytest.raises(InputError, match=r"cam2_0\.png fits none of cam1\*.*Add an ending or a pattern"):
        open_pictures("photos", "cam1*=left")
    with pytest.raises(InputError, match=r"An ending is that of the name 'cam1_0'.*'left\*=left,right"):
        open_pictures("photos", "_8=left,_9=right")


@pytest.mark.parametrize(
    "typed",
    ["cam1_*.png=1,cam2_*.png=2", "cam{camera}_{view}.png", "cam{camera}_*.png", "{camera}.png"],
)
def test_the_ending_of_files_may_be_typed(
    typed: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = [f"{n}-{c}.png" for c in (1, 2) for n in range(3)] if typed == "{camera}.png" else CAMS
    laid_out(names, tmp_path, monkeypatch)
    assert cameras_of(open_pictures("photos", typed.replace("{camera}.png", "-{camera}.png"))) == {
        "1": 3,
        "2": 3,
    }


def numbered(form: str, numbers: range) -> list[str]:
    return [form.format(number) for number in numbers]


APART = [
    (["left/DSC{}.jpg", "right/IMG_{}.jpg"], (8, 7), "left/*=left,right/*=right"),
    (["left/DSC{}.jpg", "right/IMG_{}.jpg"], (8, 8), "left=photos/left/,right=photos/right/"),
    (["cam1/DSC{}.jpg", "cam2/IMG_{}.jpg"], (8, 7), "cam1/*=cam1,cam2/*=cam2"),
    (["izquierda/a{}.jpg", "derecha/b_{}.jpg"], (8, 7), "derecha/*=derecha,izquierda/*=izquierda"),
    (["left_cam/d/DSC{}.jpg", "right_cam/d/IMG_{}.jpg"], (8, 7), "left_cam/*=left-cam,right_cam/*=right-cam"),
    (["a/left/x{}.jpg", "b/right/y_{}.jpg"], (8, 7), "left/*=left,right/*=right"),
    (["left{}.png", "right_{}.png"], (8, 8), "left*=left,right_*=right"),
    (["left{}.png", "right_{}.png"], (8, 6), "left*=left,right_*=right"),
    (["L_IMG{}.png", "R-{}.png"], (8, 8), "L_IMG*=left,R-*=right"),
    (["cam1_img{}.png", "cam2-{}.png"], (8, 8), "cam1_img*=cam1,cam2-*=cam2"),
]


@pytest.mark.parametrize(("forms", "counts", "option"), APART)
def test_cameras_called_so_are_told_though_their_names_are_unlike(
    forms: list[str], counts: tuple[int, int], option: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = [name for form, count in zip(forms, counts, strict=True) for name in numbered(form, range(count))]
    laid_out(names, tmp_path, monkeypatch)
    with pytest.raises(InputError, match="those of 2 cameras") as error:
        open_pictures("photos")
    given, alone = ADVICE.findall(str(error.value))
    assert given == option
    assert sorted(cameras_of(open_pictures("photos", given)).values()) == sorted(counts)
    assert cameras_of(open_pictures("photos", alone)) == {"camera": sum(counts)}


BY_SIDE, BY_CAMERA = {"left": "x", "right": "y_"}, {"camA": "x", "camB": "y_"}
NESTED = [
    (
        [f"{day}/{side}/{BY_SIDE[side]}{n}.png" for day in "ab" for side in BY_SIDE for n in range(3)],
        "*/left/*=left,*/right/*=right",
    ),
    (
        [f"{cam}/{day}/{BY_CAMERA[cam]}{n}.png" for day in "ab" for cam in BY_CAMERA for n in range(3)],
        "camA/*=camA,camB/*=camB",
    ),
]


@pytest.mark.parametrize(("names", "option"), NESTED)
def test_folders_of_cameras_are_told_beside_those_of_days(
    names: list[str], option: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    laid_out(names, tmp_path, monkeypatch)
    with pytest.raises(InputError, match="those of 2 cameras") as error:
        open_pictures("photos")
    given, alone = ADVICE.findall(str(error.value))
    assert given == option
    assert list(cameras_of(open_pictures("photos", given)).values()) == [6, 6]
    assert cameras_of(open_pictures("photos", alone)) == {"camera": 12}


DOUBTED = [
    (["e3v83e9-20210610T111400_{}.png", "e3v83ea-20210610T111400_{}.png"], (8, 8)),
    (["img_FT2KX1_{}.png", "img_FT2K1X_{}.png"], (8, 7)),
    (["IMG_{}.png", "DSC{}.png"], (8, 7)),
    (["near/{}.png", "far/img_{}.png"], (8, 7)),
]


@pytest.mark.parametrize(("forms", "counts"), DOUBTED)
def test_the_advice_of_doubts_works(
    forms: list[str], counts: tuple[int, int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = [name for form, count in zip(forms, counts, strict=True) for name in numbered(form, range(count))]
    laid_out(names, tmp_path, monkeypatch)
    (doubt,) = open_pictures("photos").warnings
    given, alone = ADVICE.findall(doubt)
    opened = open_pictures("photos", given)
    assert sorted(cameras_of(opened).values()) == sorted(counts)
    assert len({source.view for source in opened.sources}) == 8 or "near" in forms[0]
    assert open_pictures("photos", alone).warnings == ()


def test_doubts_without_a_pattern_ask_for_lists(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    laid_out([f"IMG_{n}{copy}.jpg" for n in range(5) for copy in ("", "_edited")], tmp_path, monkeypatch)
    (doubt,) = open_pictures("photos").warnings
    assert "list the pictures of each in a text file" in doubt


@pytest.mark.parametrize(
    ("names", "cameras"),
    [
        ([f"day{c}/{n}.png" for c in (1, 2) for n in range(4)], "day1/*=day1,day2/*=day2"),
        ([f"set{c}/d/{n}.png" for c in (1, 2, 3) for n in range(4)], "set1/*=set1,set2/*=set2,set3/*=set3"),
    ],
)
def test_equal_names_on_two_days_are_views_of_one_camera_or_of_all_folders(
    names: list[str], cameras: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    laid_out(names, tmp_path, monkeypatch)
    with pytest.raises(InputError, match="both view '0'") as error:
        open_pictures("photos")
    given, alone = ADVICE.findall(str(error.value))
    assert given == cameras
    assert len(cameras_of(open_pictures("photos", given))) == len(names) / 4
    assert cameras_of(open_pictures("photos", alone)) == {"camera": len(names)}


def test_folders_of_days_are_taken_into_the_views(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    laid_out([f"{day}/{n}_{c}.png" for day in "ab" for n in range(3) for c in (0, 1)], tmp_path, monkeypatch)
    with pytest.raises(InputError, match="both view '0' of camera 'left'") as error:
        open_pictures("photos", "_0=left,_1=right")
    (given,) = ADVICE.findall(str(error.value))
    assert cameras_of(open_pictures("photos", given)) == {"left": 6, "right": 6}


def test_two_endings_of_one_camera_get_names_of_their_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    laid_out([f"{n}_{c}.png" for n in range(3) for c in (0, 1)], tmp_path, monkeypatch)
    with pytest.raises(InputError, match="both view '0' of camera 'left'") as error:
        open_pictures("photos", "_0=left,_1=left")
    (given,) = ADVICE.findall(str(error.value))
    assert cameras_of(open_pictures("photos", given)) == {"left-1": 3, "left-2": 3}


def test_pictures_are_shown_from_where_they_differ(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    laid_out([f"cam{c}/set1/{n}.png" for c in (0, 1) for n in range(3)], tmp_path, monkeypatch)
    with pytest.raises(InputError, match=r"2 cameras \(cam0/set1/0\.png, cam1/set1/0\.png \.\.\.\)") as error:
        open_pictures("photos")
    given, alone = ADVICE.findall(str(error.value))
    assert cameras_of(open_pictures("photos", given)) == {"cam0": 3, "cam1": 3}
    assert cameras_of(open_pictures("photos", alone)) == {"camera": 6}
