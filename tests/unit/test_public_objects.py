"""Tables, rigs and cameras as a notebook has them: compared, shown, saved, turned into tables and drawn."""

import copy
import pickle
import sys
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from jaxtyping import TypeCheckError
from matplotlib.figure import Figure

from labcal import examples, load_target, pipeline
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import epipolar_distances, triangulation_limit
from labcal.correspond.detections import Detections
from labcal.correspond.points import Points
from labcal.errors import DeviceError, InputError, InputTypeError, OutputError, UnknownNameError
from labcal.evaluate.statistics import error_statistics
from labcal.paths import as_path

K = [[800, 0, 320], [0, 800, 240], [0, 0, 1]]


@pytest.fixture(scope="module")
def points() -> Points:
    """The example's points, reconstructed once."""
    return examples.points()


def spoilt() -> Detections:
    """Return the example's detections with one dot without an id and without a position."""
    table = examples.detections()
    has_id, position, flag = table.has_id.copy(), table.position.copy(), table.flag.astype("<U5")
    has_id[3], position[3], flag[3] = False, np.nan, "no-id"
    return replace(table, has_id=has_id, position=position, flag=flag)


def require_equal_without_hash(one: object, other: object) -> None:
    assert one == other
    assert one != "something else"
    with pytest.raises(TypeError, match="unhashable"):
        hash(one)


@pytest.mark.parametrize("make", [spoilt, examples.rig, lambda: examples.rig().camera("left")])
def test_what_is_made_twice_is_equal_and_has_no_hash(make: object) -> None:
    require_equal_without_hash(make(), make())  # type: ignore[operator]


def test_points_made_twice_are_equal(points: Points) -> None:
    require_equal_without_hash(points, examples.points())


@pytest.mark.parametrize("column", [field.name for field in fields(Detections)])
def test_every_column_counts(column: str) -> None:
    table = examples.detections()
    other = getattr(table, column).copy()
    other[5] = {"U": "x", "b": False}.get(other.dtype.kind, 7)
    assert replace(table, **{column: other}) != table


def test_cameras_differ_in_any_parameter() -> None:
    camera = Camera(K, "brown5", [0.1, 0, 0, 0, 0], np.eye(4), (640, 480))
    assert replace(camera, dist=[0.1, 0, 0, 1e-9, 0]) != camera
    assert replace(camera, size=[640, 481]) != camera


@pytest.mark.parametrize("which", ["detections", "points", "rig"])
def test_saved_is_loaded_as_it_was_and_not_overwritten(which: str, points: Points, tmp_path: Path) -> None:
    given = {"detections": spoilt, "points": lambda: points, "rig": examples.rig}[which]()
    path = str(tmp_path / "file")
    given.save(path)
    if not isinstance(given, Detections):  # a table's covariance of no position is no more
        assert type(given).load(path) == given
    with pytest.raises(OutputError):
        given.save(path)
    given.save(path, force=True)


def test_a_table_takes_what_numpy_takes() -> None:
    table = Detections(
        view=["a", "a"],
        camera=("left", "left"),
        image=["a.png"] * 2,
        size=[[640, 480]] * 2,
        index=np.array([[0, 0], [1, 0]], dtype=np.int32),
        has_id=[True, True],
        position=np.float32([[10, 20], [30, 20]]),
        covariance=[np.eye(2)] * 2,
        flag=["ok", "blurred"],
    )
    assert table.position.dtype == np.float64
    assert table.index.dtype == np.int64
    assert table.ok.tolist() == [True, False]
    assert repr(table) == "Detections(views=1, cameras=['left'], dots=2, ok=1)"


def test_a_spot_without_an_id_is_not_counted_as_a_dot() -> None:
    assert repr(spoilt()).endswith("dots=1407, ok=1407, without_id=1)")


@pytest.mark.parametrize(
    ("column", "value", "error", "told"),
    [
        ("position", np.zeros((1408, 3)), InputError, r"position must have the shape \(1408, 2\)"),
        ("position", np.zeros((3, 2)), InputError, r"but has the shape \(3, 2\)"),
        ("index", np.full((1408, 2), 0.5), InputError, "index must hold whole numbers"),
        ("flag", np.zeros(1408), InputTypeError, "flag must be an array of texts"),
        ("has_id", ["yes"] * 1408, InputTypeError, "has_id must be an array of truth values"),
    ],
)
def test_a_column_that_does_not_fit_is_refused(
    column: str, value: object, error: type[Exception], told: str
) -> None:
    with pytest.raises(error, match=told):
        replace(examples.detections(), **{column: value})


def test_a_camera_takes_lists_and_refuses_other_shapes() -> None:
    camera = Camera(K, "pinhole", [0] * 5, np.eye(4, dtype=np.float32), (640, 480))
    np.testing.assert_array_equal(camera.project([0, 0, 500]).q, [320.0, 240.0])
    np.testing.assert_array_equal(camera.rays([[320, 240]]).direction, [[0.0, 0.0, 1.0]])
    masked = np.ma.array([[0.0, 0.0, 500.0], [0.0, 0.0, 500.0]], mask=[[False] * 3, [True, False, False]])
    assert camera.project(masked).ok.tolist() == [True, False]
    with pytest.raises(InputError, match=r"p must have the shape \(\.\.\., 3\), but has the shape \(2, 2\)"):
        camera.project([[1, 2], [3, 4]])
    with pytest.raises(InputError, match="ragged"):
        camera.project([[1, 2, 3], [3, 4]])
    with pytest.raises(InputTypeError, match="real numbers"):
        camera.rays(["a", "b"])
    with pytest.raises(InputError, match=r"K must have the shape \(3, 3\)"):
        Camera([1, 2, 3], "pinhole", [0] * 5, np.eye(4), (640, 480))


@pytest.mark.parametrize("path", [None, 3, b"rig.json"])
def test_what_is_no_path_is_refused(path: object) -> None:
    with pytest.raises((InputTypeError, TypeCheckError)):  # the checker of the tests may be first
        as_path(path)  # type: ignore[arg-type]


def test_html_takes_nothing_for_html() -> None:
    table = examples.detections()
    shown = replace(table, camera=np.where(table.camera == "left", "<b>&", "right"))._repr_html_()
    assert "<b>" not in shown
    assert "&lt;b&gt;&amp;" in shown
    assert "\n" not in repr(table)


def test_tables_of_pandas_have_the_columns_of_the_files(tmp_path: Path, points: Points) -> None:
    pandas = pytest.importorskip("pandas")
    for given in (spoilt(), points):
        path = tmp_path / type(given).__name__
        given.save(path)
        written = pandas.read_csv(path, comment="#").dropna(how="all")
        found = given.to_pandas()
        assert found.columns.tolist() == written.columns.tolist()
        numbers = [name for name in written.columns if written[name].dtype.kind in "fi"]
        expected = written[numbers].to_numpy(dtype=float, na_value=np.nan)[: len(given)]
        np.testing.assert_array_equal(found[numbers].to_numpy(dtype=float, na_value=np.nan), expected)


def test_arrays_of_xarray_hold_each_dot_at_its_place() -> None:
    pytest.importorskip("xarray")
    table = spoilt()
    found = table.to_xarray()
    assert found["position"].dims == ("view", "camera", "dot", "coordinate")
    assert found["position"].attrs["units"] == "px"
    assert found.attrs["dots_without_id"] == 1
    line = 200
    col, row = table.index[line]
    dot = int(np.flatnonzero((found["col"] == col) & (found["row"] == row))[0])
    place = found.sel(view=table.view[line], camera=table.camera[line]).isel(dot=dot)
    np.testing.assert_array_equal(place["position"].to_numpy(), table.position[line])
    assert int(found["position"].notnull().all("coordinate").sum()) == len(table) - 1
    with pytest.raises(InputError, match="listed twice for a picture"):
        table.where(np.array([0, 0])).to_xarray()


def test_without_the_library_the_error_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, points: Points
) -> None:
    for name in ("pandas", "xarray"):
        monkeypatch.setitem(sys.modules, name, None)
    for name, ask in (("pandas", examples.rig().to_pandas), ("xarray", points.to_xarray)):
        with pytest.raises(DeviceError, match=rf"pip install {name} \("):
            ask()


def test_figures_say_their_units(points: Points) -> None:
    table, rig = spoilt(), examples.rig()
    drawn = {
        "x (px)": [table.plot("hand-0", "left"), table.plot()],
        "X (mm)": [rig.plot(), points.plot()],
        "u (px)": [rig.camera("left").plot()],
    }
    for label, figures in drawn.items():
        for figure in figures:
            assert isinstance(figure, Figure)
            figure.canvas.draw()
            assert figure.axes[0].get_xlabel() == label
    (axes,) = table.plot("hand-0", "left").axes
    assert "enlarged" in axes.get_title()
    drawn_dots = sum(len(part.get_offsets()) for part in axes.collections[:-1])
    of_picture = (table.view == "hand-0") & (table.camera == "left")
    assert drawn_dots == int(np.isfinite(table.position[of_picture]).all(axis=1).sum())
    with pytest.raises(UnknownNameError, match="hand-0"):
        table.plot("hand-00")


def test_the_middle_of_the_example_is_where_its_cameras_look(points: Points) -> None:
    assert isinstance(points, Points)
    assert isinstance(examples.rig(), Rig)
    q = examples.detections().position
    assert np.isfinite(q).all()
    np.testing.assert_allclose(np.linalg.norm(np.ptp(points.point, axis=0)), 400.0, atol=120.0)


def test_lines_are_chosen_by_anything_that_numpy_takes(points: Points) -> None:
    for table in (examples.detections(), points):
        first = np.arange(len(table)) < 2
        expected = table.where(first)
        assert len(expected) == 2
        for mask in (first.tolist(), [0, 1], (0, 1), np.int8([0, 1])):
            assert table.where(mask) == expected
        assert len(table.where([])) == 0
        with pytest.raises(InputError, match=r"mask must have the shape"):
            table.where([True, False])
        with pytest.raises(InputError, match="numbers of lines"):
            table.where([len(table)])
        with pytest.raises(InputTypeError, match="whole numbers"):
            table.where(["ok"])


def test_limits_and_distances_take_lists_and_refuse_other_shapes(points: Points) -> None:
    cameras = [examples.rig().camera(name) for name in ("left", "right")]
    p = points.point[:3]
    covariance = np.tile(np.eye(2), (3, 2, 1, 1))
    q = [camera.project(p).q for camera in cameras]
    limit = triangulation_limit(cameras, p, covariance)
    np.testing.assert_array_equal(triangulation_limit(cameras, p.tolist(), covariance.tolist()), limit)
    distances = epipolar_distances(*cameras, *q)
    np.testing.assert_array_equal(epipolar_distances(*cameras, *(one.tolist() for one in q)), distances)
    np.testing.assert_allclose(distances, 0.0, atol=1e-6)
    found = error_statistics([[1, 0, 0]], [[0, 0, 0]])
    assert (found.n, found.mae_mm) == (1, 1.0)
    with pytest.raises(InputError, match=r"covariance must have the shape \(3, 2, 2, 2\)"):
        triangulation_limit(cameras, p, covariance[:, :1])
    with pytest.raises(InputError, match=r"q_b must have the shape \(3, 2\)"):
        epipolar_distances(*cameras, q[0], q[1][:2])
    with pytest.raises(InputError, match=r"true must have the shape \(1, 3\)"):
        error_statistics([[1, 0, 0]], [[0, 0, 0], [0, 0, 0]])


def test_an_object_is_not_changed_by_what_it_was_made_of_nor_in_place(points: Points) -> None:
    def changed(array: np.ndarray) -> None:
        array[...] = "x" if array.dtype.kind == "U" else 1

    for made in (examples.detections(), points, examples.rig().camera("left")):
        arrays = [one.name for one in fields(made) if isinstance(getattr(made, one.name), np.ndarray)]
        given = {name: getattr(made, name).copy() for name in arrays}
        same = replace(made, **given)
        for name in arrays:
            changed(given[name])
            with pytest.raises(ValueError, match="read-only"):
                changed(getattr(same, name))
        assert same == made


def test_a_camera_projects_the_same_whatever_becomes_of_its_matrix() -> None:
    matrix, pose = np.array(K, dtype=np.float64), np.eye(4)
    camera = Camera(matrix, "brown5", [0.1, 0, 0, 0, 0], pose, (640, 480))
    before = camera.project([10, 20, 500]).q
    matrix[0, 0], pose[0, 3] = 1.0, 300.0
    np.testing.assert_array_equal(camera.project([10, 20, 500]).q, before)
    with pytest.raises(ValueError, match="read-only"):
        camera.centre[0] = 7.0


def _pickled(one: object) -> object:
    """Return an object as another process would receive it."""
    return pickle.loads(pickle.dumps(one))  # noqa: S301 -- it was pickled here


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, _pickled])
def test_a_copy_is_equal(copied: Callable[[object], object], points: Points, tmp_path: Path) -> None:
    shoot, target = examples.shoot(tmp_path / "shoot", views=1), load_target(examples.TARGET)
    training = pipeline.training_of(target, examples.detections(), pipeline.FitSettings(lens="brown5"))
    pictures = pipeline.open_pictures(shoot)
    for one in (spoilt(), points, examples.rig(), examples.rig().camera("left"), shoot, training, pictures):
        assert copied(one) == one
    assert repr(training) == "Training(cameras=['left', 'right'], views=8, points=704, warnings=0)"
    assert repr(pictures) == "PictureSet(name=shoot, pictures=2, cameras=['left', 'right'])"
