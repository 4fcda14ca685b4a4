import json
import pickle
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from safetensors import safe_open
from safetensors.numpy import save_file

from labcal.errors import InputError, OutputError, UnknownNameError
from labcal.estimators.camera_estimator import CameraEstimator
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.model_file import ModelKind, load_model, model_kind, save_model
from labcal.estimators.model_header import VERSION, ModelHeader
from labcal.estimators.networks.mlp import Mlp
from labcal.estimators.networks.mlp_bayes import MlpBayes
from labcal.estimators.networks.ray_net import RayNet
from labcal.estimators.registry import make_estimator, method_names

View = Callable[[np.ndarray], np.ndarray]


def fitted(name: str, X: np.ndarray, Y: np.ndarray) -> Model:
    estimator = make_estimator(name)
    if isinstance(estimator, Mlp | MlpBayes | RayNet):
        estimator.set_params(hidden=(5, 6), max_epochs=4, restarts=2, random_state=2)
    if isinstance(estimator, CameraEstimator):
        estimator.set_params(lens="pinhole")
    estimator.fit(X, Y)
    return Model(estimator, ("left", "right"), ((640, 480), (800, 600)), TrainingBox.of(X, Y))


@pytest.fixture
def saved(tmp_path: Path, stereo: View, volume: np.ndarray) -> Path:
    path = tmp_path / "model.safetensors"
    save_model(path, fitted("mlp", stereo(volume), volume), force=False)
    return path


def rewritten(path: Path, change: Callable[[dict[str, object]], None]) -> Path:
    """Change the JSON header of a model file, keeping its arrays."""
    raw = path.read_bytes()
    (length,) = struct.unpack("<Q", raw[:8])
    header = json.loads(raw[8 : 8 + length])
    content = json.loads(header["__metadata__"]["labcal"])
    change(content)
    header["__metadata__"]["labcal"] = json.dumps(content)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    path.write_bytes(struct.pack("<Q", len(text)) + text + raw[8 + length :])
    return path


@pytest.mark.parametrize("name", method_names())
def test_round_trip_is_exact(
    name: str, tmp_path: Path, stereo: View, plane: np.ndarray, volume: np.ndarray, other_volume: np.ndarray
) -> None:
    Y = plane if name == "homography" else volume
    before = fitted(name, stereo(Y), Y)
    before.estimator.own_scale_ = 1.75
    save_model(tmp_path / "m", before, force=False)
    after = load_model(tmp_path / "m")
    seen = stereo(other_volume)
    assert after.estimator.predict(seen).tobytes() == before.estimator.predict(seen).tobytes()
    covariance = np.broadcast_to(0.01 * np.eye(2), (len(seen), 2, 2, 2))
    stated, kept = (one.estimator.predict_with_covariance(seen, covariance)[1] for one in (before, after))
    assert kept.tobytes() == stated.tobytes()
    assert after.estimator.get_params() == before.estimator.get_params()
    assert (after.cameras, after.image_sizes) == (before.cameras, before.image_sizes)
    assert after.box.planar is (name == "homography")
    np.testing.assert_array_equal(after.box.low_mm, Y.min(axis=0))
    np.testing.assert_array_equal(after.box.high_px, stereo(Y).max(axis=0))
    for fact in before.estimator.fitted_facts:
        assert getattr(after.estimator, fact) == getattr(before.estimator, fact)
    assert model_kind(tmp_path / "m") is ModelKind.FITTED
    save_model(tmp_path / "again", after, force=False)
    assert (tmp_path / "again").read_bytes() == (tmp_path / "m").read_bytes()


def test_an_existing_file_is_not_replaced_unasked(saved: Path) -> None:
    model = load_model(saved)
    with pytest.raises(OutputError, match="exists already"):
        save_model(saved, model, force=False)
    save_model(saved, model, force=True)


@pytest.mark.parametrize("keep", [0, 4, 20, 500, -1])
def test_a_truncated_file_is_refused(saved: Path, keep: int) -> None:
    saved.write_bytes(saved.read_bytes()[:keep])
    with pytest.raises(InputError, match="truncated, damaged, or no model"):
        load_model(saved)


def test_foreign_files_are_refused(tmp_path: Path) -> None:
    save_file({"a": np.zeros(3)}, tmp_path / "other.safetensors")
    with pytest.raises(InputError, match="no model of labcal"):
        load_model(tmp_path / "other.safetensors")
    with pytest.raises(InputError, match="cannot be read"):
        load_model(tmp_path / "missing")
    (tmp_path / "text").write_text("hello, this is no model at all")
    with pytest.raises(InputError, match="no model"):
        load_model(tmp_path / "text")


def test_a_pickle_is_refused_and_does_not_run(tmp_path: Path) -> None:
    class Bomb:
        def __reduce__(self) -> tuple[object, tuple[object, ...]]:
            return (Path.touch, (tmp_path / "exploded",))

    (tmp_path / "bomb").write_bytes(pickle.dumps(Bomb()))
    with pytest.raises(InputError):
        load_model(tmp_path / "bomb")
    with pytest.raises(InputError):
        model_kind(tmp_path / "bomb")
    assert not (tmp_path / "exploded").exists()


def test_a_newer_version_is_refused_by_its_number(saved: Path) -> None:
    rewritten(saved, lambda header: header.update(version=VERSION + 1, something_new=True))
    with pytest.raises(InputError, match=rf"version {VERSION + 1}.*Install a newer"):
        load_model(saved)


def test_an_older_version_is_refused_by_its_number(saved: Path) -> None:
    rewritten(saved, lambda header: header.update(version=1))
    with pytest.raises(InputError, match=r"version 1.*Fit it again"):
        load_model(saved)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"cameras": ["right", "left"]}, "has been changed"),
        (
            {
                "parameters": {
                    "hidden": [5, 7],
                    "goal": 1e-7,
                    "max_epochs": 4,
                    "members": 1,
                    "restarts": 1,
                    "random_state": 2,
                }
            },
            "has been changed",
        ),
        ({"surprise": 1}, "surprise: this key is not known"),
        ({"format": "other"}, "format"),
        ({"inputs": "four"}, "inputs"),
        ({"version": "1"}, "version"),
    ],
)
def test_a_changed_header_is_refused(saved: Path, change: dict[str, object], message: str) -> None:
    rewritten(saved, lambda header: header.update(change))
    with pytest.raises(InputError, match=message):
        load_model(saved)


def test_a_changed_number_is_refused(saved: Path) -> None:
    raw = bytearray(saved.read_bytes())
    raw[-3] ^= 1
    saved.write_bytes(raw)
    with pytest.raises(InputError, match="has been changed"):
        load_model(saved)


def resigned(path: Path, change: dict[str, object]) -> Path:
    """Change the header and make the digest right again, as a determined hand could."""

    def apply(header: dict[str, object]) -> None:
        header.update(change)
        with safe_open(path, framework="numpy") as file:
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 - no mapping
        header["digest"] = ModelHeader.model_validate_json(json.dumps(header)).signed(arrays).digest

    return rewritten(path, apply)


def test_even_with_a_right_digest_only_known_methods_parameters_and_shapes_are_used(saved: Path) -> None:
    original = saved.read_bytes()
    load_model(resigned(saved, {}))
    with pytest.raises(UnknownNameError, match="no method named 'os'"):
        load_model(resigned(saved, {"method": "os"}))
    saved.write_bytes(original)
    with pytest.raises(InputError, match="names parameters"):
        load_model(resigned(saved, {"parameters": {"__class__": "x"}}))
    saved.write_bytes(original)
    with pytest.raises(InputError, match="names parameters"):
        load_model(resigned(saved, {"facts": {"n_iter_": 1, "stop_reason_": "x", "fit": 0.0}}))
    saved.write_bytes(original)
    with pytest.raises(InputError, match="lacks the array 'parameters_'"):
        load_model(
            resigned(
                saved,
                {
                    "parameters": {
                        "hidden": [9],
                        "goal": 1e-7,
                        "max_epochs": 4,
                        "members": 1,
                        "restarts": 1,
                        "random_state": 2,
                    }
                },
            )
        )
    saved.write_bytes(original)
    with pytest.raises(InputError, match=r"'box\.low_mm'"):
        load_model(resigned(saved, {"outputs": 4}))


def test_kinds_are_told_apart(saved: Path, tmp_path: Path) -> None:
    assert model_kind(saved) is ModelKind.FITTED
    (tmp_path / "rig.json").write_text('\n {"cameras": {}}')
    assert model_kind(tmp_path / "rig.json") is ModelKind.RIG
    (tmp_path / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    with pytest.raises(InputError, match="neither a model"):
        model_kind(tmp_path / "picture.png")
    with pytest.raises(InputError, match="cannot be read"):
        model_kind(tmp_path)


def test_parts_that_do_not_belong_together_are_refused(stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    estimator, box = make_estimator("affine").fit(X, volume), TrainingBox.of(X, volume)
    with pytest.raises(InputError, match="2 cameras with a picture size each"):
        Model(estimator, ("left",), ((640, 480),), box)
    with pytest.raises(InputError, match="name of its own"):
        Model(estimator, ("left", "left"), ((640, 480), (640, 480)), box)
    with pytest.raises(InputError, match="training box"):
        Model(estimator, ("left", "right"), ((640, 480), (640, 480)), TrainingBox.of(X, volume[:, :2]))


def test_box_holds_what_was_trained(stereo: View, plane: np.ndarray, volume: np.ndarray) -> None:
    box = TrainingBox.of(stereo(volume), volume)
    assert box.holds(volume).all()
    assert not box.holds(volume + 1000.0).any()
    flat = TrainingBox.of(stereo(plane), plane)
    assert flat.planar
    np.testing.assert_array_equal(
        flat.holds(np.array([[1000.0, 1000.0, 200.1], [600.0, 1000.0, 200.0]])), [True, False]
    )


def test_a_model_keeps_what_it_was_taught_and_what_not(
    tmp_path: Path, stereo: View, volume: np.ndarray
) -> None:
    model = replace(fitted("affine", stereo(volume), volume), calibrated_on=("a", "c"), held_out=("b",))
    save_model(tmp_path / "m", model, force=False)
    kept = load_model(tmp_path / "m")
    assert (kept.calibrated_on, kept.held_out) == (("a", "c"), ("b",))


def test_a_model_of_before_says_nothing_of_views(saved: Path) -> None:
    content: dict[str, object] = {}
    rewritten(saved, content.update)
    assert not {"calibrated_on", "held_out"} & content.keys()  # what is not known is left out, as it was then
    assert load_model(saved).calibrated_on == ()
