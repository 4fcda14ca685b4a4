"""Tables of other programs become named pixels: where each counts from, and what is left out or damaged."""

from pathlib import Path

import numpy as np
import pytest

from labcal import InputError, NamedPixels, examples, measure, read_pixels
from labcal.cli import main
from labcal.correspond.interop.pixels.registry import PIXEL_FORMATS
from labcal.errors import OutputError, UnknownNameError
from labcal.pipeline import ConvertSettings, MeasureSettings, convert


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def converted(*inputs: str, **settings: object) -> NamedPixels:
    convert(list(inputs), "pixels.csv", ConvertSettings(**settings), force=True)  # type: ignore[arg-type]
    return read_pixels("pixels.csv")


def rows(pixels: NamedPixels) -> list[tuple[str, str, str, float, float]]:
    names = zip(pixels.view.tolist(), pixels.camera.tolist(), pixels.point.tolist(), strict=True)
    return [(*of, *xy) for of, xy in zip(names, pixels.position.tolist(), strict=True)]


COLMAP = """# Image list with two lines of data per image:
#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME
1 1 0 0 0 0 0 0 1 a_left.png
100.5 50.5 7 3 4 -1 20.25 30.5 9
2 1 0 0 0 0 0 0 2 a_right.png
90.5 50.5 7 1.5 1.5 9 2.5 2.5 9

3 1 0 0 0 0 0 0 1 b_left.png
"""


def test_tracks_of_colmap_are_half_a_pixel_less() -> None:
    Path("model").mkdir()
    Path("model/images.txt").write_text(COLMAP.replace("\n\n3", "\n3"))
    done = convert("model", "pixels.csv", ConvertSettings("colmap-tracks", cameras="_left=left,_right=right"))
    assert rows(read_pixels("pixels.csv")) == [
        ("a", "left", "point-7", 100.0, 50.0),
        ("a", "left", "point-9", 19.75, 30.0),
        ("a", "right", "point-7", 90.0, 50.0),
    ]
    assert done.points == 3
    assert done.cameras == ["left", "right"]
    assert "1 pixel of no point left out" in done.notes
    assert "2 pixels of points that are observed twice in an image left out" in done.notes
    with pytest.raises(InputError, match="cameras measured as one"):
        convert("model/images.txt", "other.csv", ConvertSettings("colmap-tracks"))


DLC = """scorer,net,net,net,net,net,net
bodyparts,paw,paw,paw,nose,nose,nose
coords,x,y,likelihood,x,y,likelihood
0,10.25,20.5,0.99,30.0,40.0,0.61
1,11.25,21.5,0.59,,,
"""
LABELS = """scorer,,,me,me,me,me
individuals,,,one,one,two,two
bodyparts,,,paw,paw,paw,paw
coords,,,x,y,x,y
labeled-data,video,img007.png,1.5,2.5,3.5,4.5
labeled-data,video,img012.png,,,5.5,6.5
"""


def test_tables_of_deeplabcut_leave_out_what_is_unlikely_or_not_labelled() -> None:
    Path("left.csv").write_text(DLC)
    Path("right.csv").write_text(DLC.replace("10.25", "9.25"))
    pixels = converted("left.csv", "right.csv", from_format="dlc")
    assert rows(pixels) == [
        ("0", "left", "paw", 10.25, 20.5),
        ("0", "left", "nose", 30.0, 40.0),
        ("0", "right", "paw", 9.25, 20.5),
        ("0", "right", "nose", 30.0, 40.0),
    ]
    strict = converted("left.csv", from_format="dlc", likelihood=0.9)
    assert rows(strict) == [("0", "left", "paw", 10.25, 20.5)]
    done = convert("left.csv", "other.csv", ConvertSettings("dlc", likelihood=0.0))
    assert done.points == 3
    assert "0 pixels with a likelihood below 0 left out" in done.notes[-1]


def test_labels_of_several_individuals_are_read_with_the_trials_name() -> None:
    Path("day1-camA.csv").write_text(LABELS)
    pixels = converted("day1-camA.csv", from_format="dlc", cameras="-camA=left,-camB=right")
    assert rows(pixels) == [
        ("day1-img007", "left", "one-paw", 1.5, 2.5),
        ("day1-img007", "left", "two-paw", 3.5, 4.5),
        ("day1-img012", "left", "two-paw", 5.5, 6.5),
    ]


DICE = """***
*** Digital Image Correlation Engine (DICe)
*** Coordinates given with (0,0) as upper left corner of image
***
SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,SIGMA,GAMMA,BETA,STATUS_FLAG
0,100,50,0.25,-0.5,0.004,0.001,0,4
1,110,50,0,0,-1,-1,-1,5
"""


def test_subsets_of_dice_stand_where_they_moved_to() -> None:
    Path("0001_left.txt").write_text(DICE)
    pixels = converted("0001_left.txt", from_format="dice-subsets", cameras="_left=left,_right=right")
    assert rows(pixels) == [("0001", "left", "0", 100.25, 49.5)]
    assert not pixels.has_covariance.any()


VIC = """"X", "Y", "Z", "sigma", "x", "y", "u", "v", "q", "r"
1.0, 2.0, 3.0, 0.01, 100, 50, 0.25, 0.5, -40.5, 1.25
1.5, 2.0, 3.0, -1, 110, 50, 0, 0, 0, 0
"""


def test_columns_are_named_where_no_form_is_fixed() -> None:
    Path("step-3.csv").write_text(VIC)
    columns = "sigma=sigma,left=x+u:y+v,right=x+q:y+r"
    pixels = converted("step-3.csv", from_format="columns", columns=columns)
    assert rows(pixels) == [
        ("step-3", "left", "0", 100.25, 50.5),
        ("step-3", "right", "0", 59.5, 51.25),
    ]
    np.testing.assert_allclose(pixels.covariance, np.tile(1e-4 * np.eye(2), (2, 1, 1)))
    Path("long.txt").write_text("frame id camera-x camera-y\n7 tip 1.5 2.5\n8 tip 1.75 2.25\n")
    named = converted(
        "long.txt", from_format="columns", cameras="long=left",
        columns="view=frame,point=id,camera=camera-x:camera-y",
    )  # fmt: skip
    assert rows(named) == [("7", "left", "tip", 1.5, 2.5), ("8", "left", "tip", 1.75, 2.25)]


def test_pixels_of_another_program_become_points() -> None:
    """The whole way: the same points as from the pixels themselves."""
    given, rig = examples.pixels(), examples.rig()
    lines = ["id,xl,yl,xr,yr"]
    for name in dict.fromkeys(given.point.tolist()):
        left, right = given.position[given.point == name].tolist()
        lines.append(",".join([name, *map(repr, (*left, *right))]))
    Path("block.csv").write_text("\n".join(lines) + "\n")
    converted("block.csv", from_format="columns", columns="point=id,left=xl:yl,right=xr:yr")
    settings = MeasureSettings(pixel_sigma=examples.SIGMA_PX)
    found = measure(rig, "pixels.csv", settings=settings).points
    expected = measure(rig, given).points
    np.testing.assert_allclose(found.point, expected.point, rtol=0, atol=1e-9)
    assert found.name.tolist() == expected.name.tolist()


@pytest.mark.parametrize(
    ("text", "settings", "why"),
    [
        (COLMAP[:300] + "oops\n", {"from_format": "colmap-tracks"}, "is no images.txt of COLMAP, or damaged"),
        (f"{COLMAP}\n5 6 7\n", {"from_format": "colmap-tracks"}, "is no images.txt of COLMAP, or damaged"),
        ("x,y\n1,2\n", {"from_format": "dlc"}, "is no table of DeepLabCut"),
        (DLC.replace("30.0", "high"), {"from_format": "dlc"}, "Line 4 .*'high' is no number"),
        (DLC.replace("30.0", "inf"), {"from_format": "dlc"}, "Line 4 .*'inf' is no pixel"),
        (DLC.replace("0.61", "0.61,7"), {"from_format": "dlc"}, "Line 4 .*8 cells, not 7"),
        (DLC.replace("nose", "paw"), {"from_format": "dlc"}, "two columns x of 'paw'"),
        (DLC, {"from_format": "dlc", "likelihood": 1.0}, "There is no pixel of a point"),
        (DLC, {"from_format": "dlc", "columns": "left=x:y"}, "`columns` does not apply to the format 'dlc'"),
        (DLC, {"from_format": "dlc", "lens": "brown5"}, "`lens` does not apply to tables of pixels"),
        (VIC, {"from_format": "columns"}, "`columns` names the columns of a table"),
        (VIC, {"from_format": "columns", "columns": "point=X"}, "`columns` names no camera"),
        (VIC, {"from_format": "columns", "columns": "left=x"}, "`columns` names the columns"),
        (VIC.replace('"u"', '"x"'), {"from_format": "columns", "columns": "left=x:y"}, "two columns 'x'"),
        (
            VIC.replace("0.01,", "1e200,"),
            {"from_format": "columns", "columns": "sigma=sigma,left=x:y"},
            "Line 2 .*no sta",
        ),
        (VIC.replace("100,", "1e200,"), {"from_format": "columns", "columns": "left=x:y"}, "is no pixel"),
        (VIC, {"from_format": "columns", "columns": "point=Y,left=x:y"}, "'2.0' is listed twice"),
        ("", {"from_format": "columns", "columns": "left=x:y"}, "holds no table"),
    ],
)
def test_what_is_damaged_or_would_be_dropped_is_refused(
    text: str, settings: dict[str, object], why: str
) -> None:
    Path("left.csv").write_text(text)
    with pytest.raises(InputError, match=why):
        converted("left.csv", **settings)
    assert not Path("pixels.csv").exists()


def test_a_column_that_is_missing_is_offered_its_nearest() -> None:
    Path("left.csv").write_text(VIC)
    with pytest.raises(UnknownNameError, match=r"named 'sigm'\. Did you mean 'sigma'"):
        converted("left.csv", from_format="columns", columns="sigma=sigm,left=x:y")


def test_a_misspelled_format_is_offered_its_nearest() -> None:
    Path("left.csv").write_text(VIC)
    with pytest.raises(UnknownNameError, match=r"named 'colums'\. Did you mean 'columns'"):
        converted("left.csv", from_format="colums", columns="left=x:y")


def test_the_table_that_is_read_is_not_replaced() -> None:
    Path("left.csv").write_text(DLC)
    with pytest.raises(OutputError, match="is an input"):
        convert("left.csv", "left.csv", ConvertSettings("dlc"), force=True)
    with pytest.raises(InputError, match=r"written as a pixels\.csv"):
        convert("left.csv", "pixels.json", ConvertSettings("dlc"))


def test_formats_are_listed_and_in_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["format", "list", "--json"]) == 0
    told = capsys.readouterr().out
    assert all(f'"format": "{name}"' in told for name in PIXEL_FORMATS)
    assert main(["convert", "--help"]) == 0
    assert ", ".join(PIXEL_FORMATS) in " ".join(capsys.readouterr().out.split())
