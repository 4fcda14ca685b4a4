"""detections.csv: written and read back exactly, and damaged in every way."""

import tracemalloc
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from edited import edited

from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import detections_csv, read_detections
from labcal.correspond.gathering import gather
from labcal.correspond.sources import Source
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.errors import InputError
from labcal.targets.grid import DotGrid, Polarity

HEADER = "view,camera,image,width_px,height_px,col,row,x_px,y_px,var_xx,var_xy,var_yy,flag"
LINE = "a,left,a.png,640,480,3,4,1.25,-0.5,0.01,0.002,0.03,ok"


@pytest.fixture
def exact(
    see: Callable[..., Detections], pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray]
) -> Detections:
    return see(pair, grid, poses)


def written(tmp_path: Path, *lines: str) -> Path:
    path = tmp_path / "detections.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_the_header_is_the_one_that_others_rely_on(exact: Detections) -> None:
    assert detections_csv(exact).splitlines()[0] == HEADER


def test_a_table_reads_back_exactly(tmp_path: Path, exact: Detections) -> None:
    rng = np.random.default_rng(1)
    n = len(exact)
    root = rng.normal(size=(n, 2, 2))
    table = replace(
        exact,
        position=exact.position + rng.normal(size=(n, 2)) / 3,
        covariance=root @ np.swapaxes(root, 1, 2) * 1e-7,
        image=np.array(
            [
                f"a folder, with 'comma' and \"quotes\"/{view}_{camera}.png"
                for view, camera in zip(exact.view, exact.camera, strict=True)
            ]
        ),
    )
    for column, value in {"position": np.nan, "covariance": np.nan, "has_id": False, "index": 0}.items():
        table = edited(table, column, 5, value)
    table = edited(edited(table, "flag", 5, DotFlag.NO_ID.value), "index", 6, (-1, 7))
    table = edited(table, "flag", 6, DotFlag.BEYOND_GRID.value)
    (tmp_path / "d.csv").write_text(detections_csv(table), encoding="utf-8")
    back = read_detections(tmp_path / "d.csv")
    for field in fields(Detections):
        np.testing.assert_array_equal(
            getattr(back, field.name), getattr(table, field.name), err_msg=field.name
        )
    assert detections_csv(back) == detections_csv(table)


def test_a_line_is_read_as_it_stands(tmp_path: Path) -> None:
    table = read_detections(
        written(tmp_path, HEADER, LINE, "a,left,a.png,640,480,,,7.0,8.0,nan,nan,nan,no-id")
    )
    assert table.index[0].tolist() == [3, 4]
    assert table.position.tolist() == [[1.25, -0.5], [7.0, 8.0]]
    assert table.covariance[0].tolist() == [[0.01, 0.002], [0.002, 0.03]]
    assert table.has_id.tolist() == [True, False]
    assert table.ok.tolist() == [True, False]
    assert table.picture_size("left") == (640, 480)


def test_a_table_without_dots_is_a_table(tmp_path: Path) -> None:
    table = read_detections(written(tmp_path, HEADER))
    assert len(table) == 0
    assert table.cameras == ()
    assert detections_csv(table) == HEADER + "\n"


@pytest.mark.parametrize(
    "line",
    [
        "",
        LINE.removesuffix(",ok"),
        LINE + ",more",
        LINE.replace("ok", "okay"),
        LINE.replace("1.25", "one"),
        LINE.replace("640", "640.5"),
        LINE.replace("640", "0"),
        LINE.replace(",3,4,", ",99999999999999999999,4,"),
        LINE.replace(",3,4,", ",,4,"),
        LINE.replace(",3,4,", ",,,"),
        LINE.replace("1.25", "nan"),
        LINE.replace("1.25", "inf"),
        LINE.replace(",left,", ",left_1,"),
        LINE.replace(",left,", ",,"),
        LINE.replace("640", "2147483648"),
        LINE.replace("1.25", "5000.0"),
        LINE.replace("1.25", "1e200"),
        LINE.replace("0.03", "-0.03"),
        LINE.replace("0.01", "0.0"),
        LINE.replace("0.002", "0.9"),  # no covariance
        LINE.replace("0.01", "1e30"),
        LINE.replace(",3,4,", ",123456,4,"),
        LINE.replace("a,left", "\x1b[2J,left"),
        LINE.replace("a.png", "b.png").replace(",3,", ",4,"),  # a second picture of the same view
        LINE.replace("640", "641").replace(",3,", ",4,"),
    ],
)
def test_a_damaged_line_is_named(tmp_path: Path, line: str) -> None:
    path = written(tmp_path, HEADER, LINE, line, LINE)
    with pytest.raises(InputError, match=r"Line 3 of .*detections\.csv is damaged"):
        read_detections(path)


def test_a_dot_is_listed_once_for_a_picture(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"Line 3 of .* is of the same dot of a picture as line 2"):
        read_detections(written(tmp_path, HEADER, LINE, LINE.replace("1.25", "2.5")))


def test_messages_of_damaged_lines_are_short(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read_detections(written(tmp_path, HEADER, "x" * 100_000))
    assert len(str(caught.value)) < 500


@pytest.mark.parametrize("content", [b"", b"x,y\n1,2\n", HEADER[:-5].encode() + b"\n"])
def test_other_tables_are_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "d.csv").write_bytes(content)
    with pytest.raises(InputError, match="is no table of detections: its first line should be view,camera"):
        read_detections(tmp_path / "d.csv")


def test_what_cannot_be_read_is_refused(tmp_path: Path) -> None:
    (tmp_path / "d.csv").write_bytes(b"\xff\xfe\x00")
    for path in (tmp_path / "none.csv", tmp_path, tmp_path / "d.csv"):
        with pytest.raises(InputError, match="cannot be read"):
            read_detections(path)


def test_pictures_of_two_sizes_are_two_cameras(exact: Detections) -> None:
    sizes = np.where((exact.view == "pose-1")[:, None], [[320, 240]], exact.size)
    with pytest.raises(InputError, match=r"320 x 240, 640 x 480.*`cameras`"):
        replace(exact, size=sizes).picture_size("right")


def dots(n: int, refusal: Refusal | None) -> PictureDots:
    return PictureDots(
        size=(640, 480),
        polarity=Polarity.BLACK_ON_WHITE,
        refusal=refusal,
        index=np.arange(2 * n).reshape(n, 2),
        has_id=np.full(n, refusal is None),
        position=np.arange(2.0 * n).reshape(n, 2),
        covariance=np.tile(np.eye(2), (n, 1, 1)),
        misfit=np.ones(n),
        flag=(DotFlag.OK if refusal is None else DotFlag.NO_ID,) * n,
        seen_at=np.zeros((n, 2)),
        outline=np.zeros((n, 2, 2)),
    )


def test_pictures_are_gathered_in_order() -> None:
    sources = [Source("b", "left", "x/b_0.png", None), Source("a", "left", "x/a_0.png", None)]
    sources.append(Source("c", "right", "x/c_1.png", None))
    table = gather(sources, [dots(2, None), dots(0, Refusal.NO_DOTS), dots(3, Refusal.NO_GRID)])
    assert table.view.tolist() == ["b", "b", "c", "c", "c"]
    assert table.image.tolist() == ["x/b_0.png"] * 2 + ["x/c_1.png"] * 3
    assert table.cameras == ("left", "right")
    assert table.views == ("b", "c")
    assert table.ok.tolist() == [True, True, False, False, False]
    assert len(gather(sources[1:2], [dots(0, Refusal.NO_DOTS)])) == 0


@pytest.mark.parametrize(
    ("line", "why"),
    [
        (LINE.removesuffix(",ok"), "it has 12 cells, not 13"),
        (LINE.replace("ok", "okay"), "its flag should be one of "),
        (LINE.replace("1.25", "one"), "x_px 'one' is no number"),
        (LINE.replace("640", "640.5"), "width and height should be whole numbers"),
        (LINE.replace(",3,4,", ",3.5,4,"), "col '3.5' is no whole number"),
        (LINE.replace(",3,4,", ",123456,4,"), "col and row are at most 10000"),
        (LINE.replace("1.25", "nan"), "far outside of its picture"),
        (LINE.replace("0.002", "0.9"), "its covariance is none"),
        (LINE.replace(",3,4,", ",,,"), "what is flagged 'ok' has a column"),
        (LINE.replace(",left,", ",left_1,"), "a camera's name has letters"),
        (LINE.replace("a,left", "\x1b[2J,left"), "control characters"),
        (LINE.replace("a.png", "a" * 5000), "more than 4096 letters"),
    ],
)
def test_a_damaged_line_says_why(tmp_path: Path, line: str, why: str) -> None:
    with pytest.raises(InputError) as caught:
        read_detections(written(tmp_path, HEADER, LINE.replace(",3,", ",5,"), line, "and,so,on"))
    assert str(caught.value).startswith(f"Line 3 of {tmp_path}")  # not the one behind it
    assert why in str(caught.value)


def test_a_table_is_left_at_its_first_bad_line(tmp_path: Path) -> None:
    bad = LINE.replace("1.25", "x")
    path = written(tmp_path, HEADER, *[bad] * 40_000)
    tracemalloc.start()
    with pytest.raises(InputError, match="Line 2 of"):
        read_detections(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 3 * path.stat().st_size


def test_lines_far_apart_may_be_of_the_same_dot(tmp_path: Path) -> None:
    lines = [LINE.replace(",3,4,", f",{n % 100},{n // 100},") for n in range(5000)]
    assert len(read_detections(written(tmp_path, HEADER, *lines))) == 5000
    with pytest.raises(InputError, match=r"Line 5002 of .* is of the same dot of a picture as line 8"):
        read_detections(written(tmp_path, HEADER, *lines, lines[6]))


def test_a_long_name_in_a_long_table_does_not_fill_the_memory(tmp_path: Path) -> None:
    lines = [LINE.replace("a,left,a.png", f"{'b' * 4000},left,{'b' * 4000}.png")]
    lines += [LINE.replace(",3,4,", f",{n % 200},{n // 200},") for n in range(35_000)]
    with pytest.raises(InputError, match="35001 lines, and a name of 4000 letters"):
        read_detections(written(tmp_path, HEADER, *lines))
