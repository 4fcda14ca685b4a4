"""A calibration, a model, a reconstruction and a shoot as a notebook has them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import labcal
from labcal import examples, pipeline
from labcal.errors import InputError, OutputError
from labcal.estimators.affine import Affine
from labcal.estimators.model import Model, TrainingBox
from labcal.shoot.manifest import Manifest
from labcal.shoot.pictures import write_single_picture

SIZES = ((640, 480), (640, 480))


def model(seed: int) -> Model:
    """Return an affine model of random data."""
    rng = np.random.default_rng(seed)
    X, Y = rng.uniform(0, 480, (20, 4)), rng.uniform(0, 100, (20, 3))
    return Model(Affine().fit(X, Y), ("left", "right"), SIZES, TrainingBox.of(X, Y), calibrated_on=("a",))


def test_a_model_is_equal_to_itself_loaded_and_to_no_other(tmp_path: Path) -> None:
    path = str(tmp_path / "model")
    given = model(1)
    given.save(path)
    assert Model.load(path) == given
    assert labcal.load_model(path) == given
    assert model(2) != given
    assert replace(given, calibrated_on=()) != given
    assert replace(given, warnings=("told once",)) == given  # these are not kept in the file
    with pytest.raises(OutputError):
        given.save(path)
    given.save(path, force=True)


def test_a_calibration_shows_saves_and_lists_its_cameras(tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    made = pipeline.calibrate(labcal.load_target(examples.TARGET), examples.detections())
    # Both coordinates have the noise of the example, and 1408 dots leave little to chance.
    assert made.found.rms_px == pytest.approx(np.sqrt(2) * examples.SIGMA_PX, rel=0.05)
    path = str(tmp_path / "rig.json")
    made.save(path)
    assert labcal.Rig.load(path) == made.rig
    assert repr(made).startswith("Calibration(cameras=['left', 'right'], lens=brown5, views=8, rms=0.028")
    table = made.to_pandas()
    assert table["dots"].tolist() == [704, 704]
    assert table["rms_px"].tolist() == [made.found.fits[name].rms_px for name in ("left", "right")]
    shown = replace(made, warnings=("<script>",))._repr_html_()
    assert "<script>" not in shown
    assert "&lt;script&gt;" in shown


def test_a_reconstruction_says_how_many_points_it_has() -> None:
    target = labcal.load_target(examples.TARGET)
    found = pipeline.reconstruct(examples.rig(), examples.detections(), target)
    assert repr(found).startswith("Reconstruction(points=704, ok=704, median_residual=0.0")
    assert found == pipeline.reconstruct(examples.rig(), examples.detections(), target)
    assert found != replace(found, miss_px=1.0)


def test_a_shoot_is_compared_shown_and_drawn(tmp_path: Path) -> None:
    view = {
        "name": "a",
        "images": {"left": "images/a_left.png"},
        "role": "train",
        "T_world_target_nominal": None,
    }
    manifest = {
        "target": labcal.load_target(examples.TARGET).model_dump(),
        "cameras": {"left": {"size": (40, 30)}, "right": {"size": (40, 30)}},
        "views": [view],
    }
    (tmp_path / "shoot.json").write_text(Manifest.model_validate(manifest).model_dump_json())
    (tmp_path / "images").mkdir()
    picture = np.zeros((30, 40), dtype=np.uint8)
    picture[3, 4] = 9
    write_single_picture(tmp_path / "images" / "a_left.png", picture)
    shoot = labcal.Shoot.load(str(tmp_path))
    assert shoot == labcal.open_shoot(tmp_path)
    assert shoot != shoot.showing(labcal.load_target("paper-13x10"))
    assert "target=plain-11x8, cameras=['left', 'right'], train=1, test=0" in repr(shoot)
    left, right = shoot.plot().axes
    drawn = np.asarray(left.images[0].get_array())
    assert np.unravel_index(drawn.argmax(), drawn.shape) == (3, 4)
    assert [text.get_text() for text in right.texts] == ["no picture"]


def test_a_shoot_is_opened_by_a_path_of_text_too(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is not a shoot"):
        labcal.Shoot.load(str(tmp_path))
