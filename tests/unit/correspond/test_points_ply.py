"""PLY files, read by a reader of the test's own that knows the format alone."""

import struct
from pathlib import Path

import numpy as np
import pytest

from labcal import InputError, Points, examples, pipeline, write_ply
from labcal.correspond.named_points import NamedPoints
from labcal.errors import OutputError

_FORMATS = {"double": "d", "float": "f", "uchar": "B", "int": "i"}


def read_ply(path: Path) -> tuple[dict[str, np.ndarray], list[str]]:
    """Return columns of the vertices, and the comments."""
    head, _, body = path.read_bytes().partition(b"end_header\n")
    magic, form, *lines = head.decode("ascii").splitlines()
    assert magic == "ply"
    comments = [line.removeprefix("comment ") for line in lines if line.startswith("comment ")]
    (element,) = [line.split() for line in lines if line.startswith("element ")]
    properties = [line.split()[1:] for line in lines if line.startswith("property ")]
    count = int(element[2])
    if form == "format ascii 1.0":
        rows = [list(map(float, line.split())) for line in body.decode("ascii").splitlines()]
    else:
        assert form == "format binary_little_endian 1.0"
        layout = struct.Struct("<" + "".join(_FORMATS[kind] for kind, _ in properties))
        assert len(body) == count * layout.size
        rows = [list(row) for row in layout.iter_unpack(body)]
    assert len(rows) == count
    return {name: np.array(rows)[:, at] for at, (_, name) in enumerate(properties)}, comments


@pytest.mark.parametrize("encoding", ["binary", "ascii"])
def test_a_reader_of_the_format_finds_points_sigmas_and_colours(tmp_path: Path, encoding: str) -> None:
    points = examples.points()
    flag = points.flag.copy()
    flag[3] = "model-misfit"
    points = Points(points.view, points.index, points.point, points.covariance, flag)
    write_ply(tmp_path / "points.ply", points, encoding)
    found, comments = read_ply(tmp_path / "points.ply")
    np.testing.assert_array_equal(np.stack([found[name] for name in "xyz"], axis=1), points.point)
    np.testing.assert_allclose(found["sigma"], points.sigma_mm, rtol=1e-6)
    np.testing.assert_allclose(found["sigma_z"] ** 2, points.covariance[:, 2, 2], rtol=1e-6)
    colours = np.stack([found[name] for name in ("red", "green", "blue")], axis=1)
    assert colours[3].tolist() == [220, 30, 30]
    others = np.delete(np.arange(len(points)), 3)
    best, worst = others[np.argmin(points.sigma_mm[others])], others[np.argmax(points.sigma_mm[others])]
    assert colours[best].tolist() == [68, 1, 84]
    assert colours[worst].tolist() == [253, 231, 37]
    assert found["ok"].tolist().count(0) == 1
    assert any("sigma from" in comment for comment in comments)


def test_points_without_a_place_are_left_out_and_counted(tmp_path: Path) -> None:
    points = NamedPoints(
        ["v"] * 3, ["a", "b", "c"], [[1, 2, 3], [np.nan] * 3, [4, 5, 6]], np.full((3, 3, 3), np.nan),
        ["ok", "too-few-cameras", "ok"],
    )  # fmt: skip
    write_ply(tmp_path / "points.ply", points)
    found, comments = read_ply(tmp_path / "points.ply")
    assert found["row"].tolist() == [0, 2]
    assert found["red"].tolist() == [128, 128]  # no covariance is known
    assert "1 point without a place" in comments
    with pytest.raises(InputError, match="None of the points has a place"):
        write_ply(tmp_path / "none.ply", points.where([1]))


def test_only_files_that_labcal_wrote_are_replaced(tmp_path: Path) -> None:
    points = pipeline.measure(examples.rig(), examples.pixels()).points
    path = tmp_path / "points.ply"
    write_ply(path, points)
    write_ply(path, points, "ascii", force=True)
    path.write_bytes(path.read_bytes().replace(b"0.0", b"0.1", 1) + b"\n")
    with pytest.raises(OutputError, match="changed since labcal wrote it"):
        write_ply(path, points, force=True)
    with pytest.raises(InputError, match="no encoding named 'big'"):
        write_ply(tmp_path / "other.ply", points, "big")
