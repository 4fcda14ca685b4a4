"""Arguments of public functions as a notebook gives them: converted, or refused before work begins."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import jaxtyping
import numpy as np
import pytest

import labcal
from labcal import examples, pipeline
from labcal.arguments import texts, truth_value, whole_number
from labcal.calibrate.adjustment.state import Lenses
from labcal.errors import InputError, InputTypeError, LabcalError, OutputError, UnknownNameError
from labcal.scene.catalogue import load_scene
from labcal.shoot.manifest import Role
from labcal.shoot.tone_curve import ToneCurve, find_tone_curve

QUICK = pipeline.FitSettings(lens="brown5", rehearsal=False)
STRANGE = (None, 3, 2.5, True, b"bytes", {}, object(), np.zeros(3))
"""Objects that are no path, no name, no settings and no table."""


@pytest.fixture(autouse=True)
def _as_users_run_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Switch off the checker of the tests, which would refuse a wrong type before labcal does."""
    monkeypatch.setattr(jaxtyping.config, "jaxtyping_disable", True)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a shoot, a rig and tables."""
    made = tmp_path_factory.mktemp("files")
    examples.shoot(made / "shoot")
    examples.rig().save(made / "rig.json")
    examples.detections().save(made / "dots.csv")
    examples.points().save(made / "points.csv")
    return made


@pytest.fixture
def home(files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with a copy of the files."""
    copied = tmp_path / "home"
    shutil.copytree(files, copied)
    monkeypatch.chdir(copied)
    return copied


def refused(call: Callable[..., object], *given: object, name: str = "") -> None:
    """Require an error of labcal's that says what was given, as a person would look for it."""
    with pytest.raises((InputError, InputTypeError)) as error:
        call(*given)
    assert name in str(error.value)


READERS: list[Callable[[Any], object]] = [
    labcal.read_rig, labcal.read_detections, labcal.read_points, labcal.load_model, labcal.open_shoot,
    labcal.load_target, labcal.Rig.load, labcal.Detections.load, labcal.Points.load, labcal.Model.load,
    labcal.Shoot.load,
]  # fmt: skip


@pytest.mark.parametrize("read", READERS)
def test_what_is_no_file_is_refused_by_every_reader(read: Callable[[Any], object], home: Path) -> None:
    Path("binary").write_bytes(bytes(range(256)))
    for given in (*STRANGE, "", "nowhere", home, "binary", "a\0b", "x" * 5000, home / ("x" * 300)):
        refused(read, given)


def test_a_path_that_no_file_can_have_is_refused_where_it_is_written(home: Path) -> None:
    for path in ("a\0b", "x" * 300, "", None, 3, b"new"):
        refused(examples.rig().save, path)
    with pytest.raises(OutputError):
        examples.rig().save(home)


def test_only_what_can_be_read_again_is_written(home: Path) -> None:
    writers: dict[Callable[..., None], object] = {
        labcal.write_rig: examples.rig(),
        labcal.write_detections: examples.detections(),
        labcal.write_points: examples.points(),
        labcal.save_model: None,
    }
    for write, right in writers.items():
        for given in (*STRANGE, *writers.values()):
            if given is not right or given is None:
                refused(write, "new", given)
    dots, points = examples.detections(), examples.points()
    named = replace(dots, camera=np.where(dots.camera == "left", "<script>", "right"))
    refused(named.save, "new", name="camera '<script>'")
    refused(replace(dots, view=["a\nb"] * len(dots)).save, "new", name="view 'a")
    refused(replace(dots, flag=["okay"] * len(dots)).save, "new", name="Did you mean 'ok'")
    refused(replace(points, view=["\x1b[2J"] * len(points)).save, "new", name=r"\x1b")
    refused(replace(points, flag=["OK"] * len(points)).save, "new", name="flag")
    camera = examples.rig().camera("left")
    alike = labcal.Rig.of({"A": camera, "a": camera})
    refused(alike.save, "new", name="capital letters")
    assert not (home / "new").exists()


def test_cameras_of_a_rig_have_names() -> None:
    camera = examples.rig().camera("left")
    for given in ({}, {"a b": camera}, {"<script>": camera}, {3: camera}, {"a": None}, [camera], None):
        refused(labcal.Rig.of, given)


def test_names_that_are_misspelt_are_answered_with_the_nearest(home: Path) -> None:
    dots, rig, shoot = examples.detections(), examples.rig(), labcal.open_shoot(home / "shoot")
    offered: dict[str, Callable[[], object]] = {
        "left": lambda: rig.camera("lefft"),
        "right": lambda: rig.baseline_mm("left", "rigth"),
        "hand-0": lambda: dots.plot("hand-00"),
        "test": lambda: shoot.views("tset"),
        "fixed": lambda: pipeline.HandheldSettings(lenses="fixd", start=rig),
        "srgb": lambda: pipeline.detect(shoot, tone_curve="sgrb"),
        "plain-11x8": lambda: shoot.showing("plain-11x9"),
        "brown5": lambda: pipeline.calibrate(examples.TARGET, dots, "brwn5"),
        "hand-3": lambda: pipeline.calibrate(examples.TARGET, dots, hold_out="hand-33"),
        "hand-4": lambda: pipeline.calibrate(examples.TARGET, dots, hold_out=["hand-44"]),
        "hybrid": lambda: pipeline.fit(examples.TARGET, dots, "hybird", QUICK),
        "dlt": lambda: pipeline.estimators_of("dtl"),
        "rigid": lambda: pipeline.evaluate("points.csv", "shoot", alignment="rigit"),
        "webcam-plane": lambda: load_scene("webcam-plan"),
        "13": lambda: pipeline.ReproduceSettings(experiments="133"),
        "opencv": lambda: pipeline.convert("rig.json", "x.yml", pipeline.ConvertSettings(to_format="opncv")),
    }
    for name, call in offered.items():
        with pytest.raises(UnknownNameError, match=f"Did you mean '{name}'"):
            call()
    with pytest.raises(UnknownNameError, match="no camera in the detections named 'lft'"):
        dots.picture_size("lft")


def test_words_are_taken_as_text() -> None:
    assert pipeline.HandheldSettings(lenses="fixed", start=examples.rig()).lenses is Lenses.FIXED
    assert pipeline.HandheldSettings(lenses=Lenses.FREE) == pipeline.HandheldSettings(lenses="free")
    assert find_tone_curve("SRGB") is find_tone_curve(Path("srgb")) is ToneCurve.SRGB
    assert pipeline.ConvertSettings(only="left").only == ("left",)
    assert pipeline.BenchSettings(groups="real", methods=["dlt"]).groups == ("real",)
    assert pipeline.ReproduceSettings(experiments=["c4", "13", "1"]).experiments == ("01", "13", "C4")
    assert pipeline.ReproduceSettings() == pipeline.ReproduceSettings(experiments=())
    assert len(pipeline.ReproduceSettings().selected.rows) == 22


def test_views_of_a_role_are_asked_for_by_text(home: Path) -> None:
    shoot = labcal.open_shoot(home / "shoot")
    assert [view.name for view in shoot.views("test")] == ["hand-1"]
    assert shoot.views("train") == shoot.views(Role.TRAIN)
    for role in ("", 3, b"test", ["test"]):
        refused(shoot.views, role, name="role")


def test_lenses_are_kept_only_of_a_rig() -> None:
    with pytest.raises(InputError, match="Give that rig: `start="):
        pipeline.HandheldSettings(lenses="fixed")


BAD_SETTINGS: list[tuple[type, str, tuple[object, ...]]] = [
    (pipeline.FitSettings, "lens", (None, 3, b"brown5")),
    (pipeline.FitSettings, "seed", (None, -1, 1.5, "3", True)),
    (pipeline.FitSettings, "rehearsal", (None, "no", 1)),
    (pipeline.FitSettings, "dot_places", (True, None)),
    (pipeline.FitSettings, "hold_out", (None, 1.5, True, b"a", [3])),
    (pipeline.HandheldSettings, "lenses", (None, 3, "")),
    (pipeline.HandheldSettings, "start", (["rig.json"], 3)),
    (pipeline.HandheldSettings, "dot_places", (False, None)),
    (pipeline.HandheldSettings, "eccentricity_rounds", (-1, 1.5, "2", None)),
    (pipeline.RenderSettings, "spp", (0, "x", 1.5, True)),
    (pipeline.RenderSettings, "views", (0, "x", 1.5, True)),
    (pipeline.RenderSettings, "seed", (-1, "x", None)),
    (pipeline.RenderSettings, "workers", (0, "x", None)),
    (pipeline.RenderSettings, "force", ("no", None, 1)),
    (pipeline.UndistortSettings, "rectify", ("no", None)),
    (pipeline.UndistortSettings, "distance_mm", (-1, 0, "100", float("nan"), True)),
    (pipeline.UndistortSettings, "force", ("no",)),
    (pipeline.ConvertSettings, "to_format", (3, ["opencv"])),
    (pipeline.ConvertSettings, "size", (3, "640 and 480", (1, 2, 3), (640.5, 480), (0, 0), (200_000, 1))),
    (pipeline.ConvertSettings, "unit", (3, "cm")),
    (pipeline.ConvertSettings, "only", (3, [3], None)),
    (pipeline.BenchSettings, "quick", ("no",)),
    (pipeline.BenchSettings, "groups", (3, None)),
    (pipeline.BenchSettings, "detections", (3, None, b"a", {"a": 1}, [3], [b"a"])),
    (pipeline.ReproduceSettings, "experiments", (3, [1], None)),
    (pipeline.ReproduceSettings, "seeds", (0, "x")),
    (pipeline.ReproduceSettings, "workers", (0, 1.5)),
]


@pytest.mark.parametrize(("settings", "name", "values"), BAD_SETTINGS)
def test_a_setting_of_a_wrong_kind_is_refused_by_name(
    settings: type, name: str, values: tuple[object, ...]
) -> None:
    for value in values:
        refused(lambda given: settings(**{name: given}), value, name=f"`{name}`" if value != "" else name)


def test_paths_of_a_benchmark_are_texts_or_paths() -> None:
    given = pipeline.BenchSettings(plan=Path("mine.yaml"), detections=[Path("monday"), "friday"])
    assert (given.plan, given.detections) == ("mine.yaml", ("monday", "friday"))
    assert pipeline.BenchSettings(detections=Path("monday")).detections == ("monday",)  # type: ignore[arg-type]


def test_numbers_of_numpy_are_numbers() -> None:
    assert pipeline.RenderSettings(seed=np.int64(3), views=np.uint8(2)) == pipeline.RenderSettings(
        seed=3, views=2
    )
    assert whole_number(np.int32(4), "n", 0) == 4
    assert whole_number(2**63 - 1, "n", 0) == 2**63 - 1
    assert truth_value(np.True_, "force") is True
    assert texts(np.array(["a", "b"]), "only") == ("a", "b")
    made = pipeline.calibrate(examples.TARGET, examples.detections(), "brown5", hold_out=np.int64(2))
    assert len(made.held_out) == 2
    named = pipeline.calibrate(examples.TARGET, examples.detections(), "brown5", hold_out="hand-0, hand-1")
    assert named.held_out == ("hand-0", "hand-1")


def test_settings_of_another_function_are_refused(home: Path) -> None:
    dots = examples.detections()
    calls: list[Callable[[Any], object]] = [
        lambda given: pipeline.detect("shoot", settings=given),
        lambda given: pipeline.inspect("shoot", settings=given),
        lambda given: pipeline.calibrate(examples.TARGET, dots, settings=given),
        lambda given: pipeline.fit(examples.TARGET, dots, "dlt", given),
        lambda given: pipeline.convert("rig.json", "new.yml", given),
        lambda given: pipeline.undistort("rig.json", "shoot", "new", given),
        lambda given: pipeline.render("webcam-plane", "new", given),
        lambda given: pipeline.estimators_of(["dlt"], given),
    ]
    for call in calls:
        for given in ({}, 0, "x", pipeline.ReproduceSettings):
            refused(call, given, name="`settings`")
    assert not (home / "new").exists()


def test_what_is_no_argument_of_the_chain_is_refused(home: Path) -> None:
    dots, target = examples.detections(), labcal.load_target(examples.TARGET)
    training = pipeline.training_of(target, dots, QUICK)
    calls: list[Callable[[Any], object]] = [
        lambda given: pipeline.detect(given, target),
        lambda given: pipeline.undistort("rig.json", given, "new"),
        lambda given: pipeline.undistort(given, "shoot", "new"),
        lambda given: pipeline.calibrate(given, dots, "brown5"),
        lambda given: pipeline.reconstruct("rig.json", given, target),
        lambda given: pipeline.reconstruct(given, dots, target),
        lambda given: pipeline.evaluate(given, target),
        lambda given: pipeline.evaluate("points.csv", given),
        lambda given: pipeline.training_of(given, dots, QUICK),
        lambda given: pipeline.training_of(target, given, QUICK),
        lambda given: pipeline.fit_methods(given, pipeline.estimators_of(["dlt"]), QUICK),
        lambda given: pipeline.fit_methods(training, given, QUICK),
        lambda given: pipeline.epipolar_rms(given, dots),
        lambda given: pipeline.epipolar_rms(examples.rig(), given),
        lambda given: pipeline.fit(target, dots, given, QUICK),
        lambda given: pipeline.convert(given, "new.yml"),
    ]
    for call in calls:
        for given in STRANGE:
            with pytest.raises(LabcalError):
                call(given)
    for given in (3, b"x", [], {}, examples.rig(), type(target)):
        with pytest.raises(InputTypeError, match="A target is"):
            pipeline.measure_pictures("shoot", given)  # type: ignore[arg-type]
    for call in (pipeline.detections_of, pipeline.detect_settings):
        for given in (3, b"x", [3], [None]):
            refused(call, given)
    assert not (home / "new").exists()


def test_tone_curves_workers_and_progress_are_checked_before_pictures_are_read(home: Path) -> None:
    for given in (3, None, b"srgb", [], 2.2):
        refused(lambda one: pipeline.detect(home / "shoot", tone_curve=one), given)
    for given in (0, -1, 1.5, "2", None, True):
        refused(lambda one: pipeline.detect(home / "shoot", workers=one), given, name="`workers`")
    for given in (3, "x", print, 0):
        refused(lambda one: pipeline.detect(home / "shoot", progress=one), given, name="`progress`")


def test_cameras_of_loose_pictures_are_named_by_a_mapping_or_a_text(home: Path) -> None:
    pictures = home / "shoot" / "images"
    by_mapping = pipeline.open_pictures(pictures, {"_left": "a", "_right": "b"})
    assert by_mapping.sources == pipeline.open_pictures(pictures, "_left=a,_right=b").sources
    for given in (3, b"x", ["_left=a"], {"_left": 3}, {3: "a"}, {"_left": "a b", "_right": "c"}, {"": "a"}):
        refused(lambda one: pipeline.open_pictures(pictures, one), given, name="`cameras`")


def test_force_is_true_or_false(home: Path) -> None:
    before = (home / "rig.json").read_bytes()
    for given in ("no", None, 1):
        refused(lambda one: examples.rig().save("rig.json", force=one), given, name="`force`")
        refused(lambda one: pipeline.convert("rig.json", "dots.csv", force=one), given, name="`force`")
    assert (home / "rig.json").read_bytes() == before


def test_a_shoot_is_reconstructed_with_its_own_target(home: Path) -> None:
    shoot = labcal.open_shoot(home / "shoot")
    expected = pipeline.reconstruct("rig.json", pipeline.detect(shoot), shoot.target)
    assert pipeline.reconstruct("rig.json", "shoot") == expected
    assert pipeline.reconstruct("rig.json", shoot) == expected
    assert expected.eccentricity is not None


def test_holding_out_nothing_of_nothing_says_that_there_are_no_dots() -> None:
    nothing = examples.detections().where([])
    with pytest.raises(InputError) as error:
        pipeline.calibrate(examples.TARGET, nothing)
    assert "held out" not in str(error.value)
    with pytest.raises(InputError, match="0 or more"):
        pipeline.calibrate(examples.TARGET, examples.detections(), hold_out=-1)


def test_arrays_of_other_kinds_are_refused_or_taken_as_they_are() -> None:
    camera, dots = examples.rig().camera("left"), examples.detections()
    torch = pytest.importorskip("torch")
    p = [[10.0, 20.0, 500.0]]
    np.testing.assert_array_equal(camera.project(torch.tensor(p)).q, camera.project(p).q)
    refused(camera.project, torch.tensor(p, requires_grad=True), name="detach")
    for given in (
        None,
        "abc",
        [[None, 1, 2]],
        [[10**400, 0, 1]],
        {1, 2, 3},
        [1, 2],
        np.zeros((1, 3), complex),
    ):
        refused(camera.project, given, name="p must")
    assert not camera.project([[np.inf, 0.0, 1.0], [np.nan, 0.0, 1.0]]).ok.any()
    for column in ("view", "index", "flag", "size", "has_id"):
        array = getattr(dots, column)
        masked = np.ma.masked_all(array.shape, array.dtype)
        refused(lambda given, name=column: replace(dots, **{name: given}), masked, name="masked")
    position = np.ma.array(dots.position, mask=np.zeros_like(dots.position, dtype=bool))
    position[0] = np.ma.masked
    assert np.isnan(replace(dots, position=position).position[0]).all()
    refused(lambda given: replace(dots, index=given), np.full((len(dots), 2), np.nan), name="whole numbers")
    for part in ("prescription", "window", "lens", "size"):
        refused(
            lambda given, name=part: replace(camera, **{name: given}),
            "x",
            name=part if part != "lens" else "",
        )


def test_an_example_has_one_view_to_eight(tmp_path: Path) -> None:
    for views in (0, -1, 9, "2", 1.5):
        refused(lambda given: examples.shoot(tmp_path / "new", given), views, name="`views`")
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("digits", [19, 400, 5000])
def test_numbers_that_have_no_place_in_a_file_are_refused(digits: int) -> None:
    """A seed of four hundred digits is no name of a file, and Python does not print one of five thousand."""
    said = r"`seed` must be at most 9223372036854775807, but a number of \d+ bits was given"
    with pytest.raises(InputError, match=said):
        pipeline.BenchSettings(seed=10**digits)
