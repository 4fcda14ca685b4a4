"""A method of one's own in ``fit``, ``reconstruct`` and ``evaluate``, as verbs and in Python."""

import contextlib
import io
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler

from labcal import pipeline
from labcal.calibrate.resection import lens_choice
from labcal.cameras.camera import Camera
from labcal.cameras.record import matrix4_record
from labcal.cli import main
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import detections_csv
from labcal.correspond.points_csv import read_points
from labcal.errors import InputError
from labcal.estimators.affine import Affine
from labcal.estimators.bundle import Bundle
from labcal.estimators.model_file import load_model, save_model
from labcal.shoot.dataset import Shoot, open_shoot, write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest, Role, ViewEntry
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
QUICK = pipeline.FitSettings(rehearsal=False)
OWN = "users_regression:Made"
CODE = """
from sklearn.linear_model import Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler

def Made():
    return make_pipeline(StandardScaler(), PolynomialFeatures(2), Ridge(1e-6))
"""


@pytest.fixture(autouse=True)
def one_lens(monkeypatch: pytest.MonkeyPatch) -> None:
    """Spare the choice among five lens models, which is not what is tested here."""
    monkeypatch.setattr(lens_choice, "OF_POINTS", ("brown5",))


@pytest.fixture
def shoot(tmp_path: Path, pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray]) -> Shoot:
    """A target on a stage that tells where it is in eight views, the last of which is to test on."""
    home = tmp_path / "shoot"
    home.mkdir()
    views = tuple(
        ViewEntry(
            name=name,
            images={camera: f"images/{name}_{camera}.png" for camera in pair},
            role=Role.TEST if name == "pose-7" else Role.TRAIN,
            T_world_target_nominal=matrix4_record(T),
        )
        for name, T in poses.items()
    )
    size = CameraEntry(size=(640, 480))
    write_manifest(home, Manifest(target=grid, cameras=dict.fromkeys(pair, size), views=views))
    return open_shoot(home)


@pytest.fixture
def dots(see: See, pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray]) -> Detections:
    exact = see(pair, grid, poses)
    noise = 0.02 * np.random.default_rng(2).normal(size=exact.position.shape)
    covariance = np.tile(0.02**2 * np.eye(2), (len(exact), 1, 1))
    return replace(exact, position=exact.position + noise, covariance=covariance)


def command(*words: object) -> tuple[int, Any]:
    """Return status and document."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        status = main([*map(str, words), "--json"])
    return status, json.loads(out.getvalue())


def test_verbs_and_python_give_the_same(
    shoot: Shoot, dots: Detections, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "users_regression.py").write_text(CODE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [entry for entry in sys.path if entry])
    Path("dots.csv").write_text(detections_csv(dots))
    words = ("fit", shoot.folder, "--detections", "dots.csv", "-o", "m.safetensors")
    status, told = command(*words, "--no-rehearsal", "--method", f"{OWN},affine")
    assert (status, [one["error"] for one in told["models"]]) == (0, [None, None])
    own = told["models"][0]
    assert (own["method"], own["file"]) == (OWN, "m-users_regression.Made.safetensors")
    assert own["n"] == 140

    given = make_pipeline(StandardScaler(), PolynomialFeatures(2), Ridge(1e-6))
    model = pipeline.fit(shoot, dots, given, QUICK)
    assert not hasattr(given, "n_features_in_")
    found = pipeline.reconstruct(model, dots, shoot.target)
    words = ("reconstruct", own["file"], "dots.csv", "--target", _target(shoot, tmp_path), "-o", "p.csv")
    status, told = command(*words)
    assert status == 2
    assert f"--method {OWN}" in told["error"]["message"]
    assert not Path("p.csv").exists()
    assert command(*words, "--method", OWN)[0] == (0 if "ok" in found.points.flag else 1)
    written = read_points(Path("p.csv"))
    np.testing.assert_allclose(written.point, found.points.point, rtol=0, atol=1e-6)
    np.testing.assert_allclose(written.covariance, found.points.covariance, rtol=1e-6)
    assert (written.flag == found.points.flag).all()
    status, told = command("evaluate", "p.csv", "--target", _target(shoot, tmp_path), "--rig", own["file"])
    assert (told["views_scored"], told["views_calibrated_on"]) == (["pose-7"], 0)  # without naming it

    words = ("reconstruct", "m-affine.safetensors", "dots.csv", "-o", "q.csv", "--method")
    status, told = command(*words, "sklearn.linear_model:Ridge")
    assert status == 2
    assert "Name no method" in told["error"]["message"]

    save_model(Path("own.safetensors"), model, force=False)
    with pytest.raises(InputError, match="name it: `method="):
        load_model(Path("own.safetensors"))
    again = load_model(Path("own.safetensors"), given)
    assert (pipeline.reconstruct(again, dots, shoot.target).points.point == found.points.point).all()


@pytest.mark.parametrize(
    ("method", "said"),
    [
        ("users_nothing:Made", "There is no module 'users_nothing'"),
        ("sklearn.linear_model:Rigde", "Did you mean 'Ridge'"),
        ("json:JSONDecoder", "has no 'fit' and 'predict'"),
        ("sklearn.preprocessing:StandardScaler", "has no 'fit' and 'predict'"),
        ("affine,,mlp", "nothing between two commas"),
        ("affine,labcal.estimators.affine:Affine", "names a method twice"),
    ],
)
def test_what_is_no_method_is_wrong_use(
    method: str, said: str, shoot: Shoot, dots: Detections, tmp_path: Path
) -> None:
    table, model = tmp_path / "dots.csv", tmp_path / "m.safetensors"
    table.write_text(detections_csv(dots))
    words = ("--method", method, "--detections", table, "--no-rehearsal", "-o", model)
    status, told = command("fit", shoot.folder, *words)
    assert status == 2
    assert re.search(said, told["error"]["message"])
    assert not model.exists()


def test_fit_takes_names_classes_and_estimators_and_leaves_them_as_they_were(
    shoot: Shoot, dots: Detections
) -> None:
    given = [
        "affine",
        Affine(),
        Affine,
        "labcal.estimators.affine:Affine",
        LinearRegression,
        Bundle("brown5"),
    ]
    training = pipeline.training_of(shoot, dots, QUICK)
    estimators = pipeline.estimators_of(given, QUICK)
    models = pipeline.fit_methods(training, estimators, QUICK)
    by_name = models[0].estimator
    for model in models[:4]:
        assert (model.estimator.coefficients_ == by_name.coefficients_).all()
    assert not any(hasattr(estimator, "n_outputs_") for estimator in [*given, *estimators])
    assert given[-1].image_sizes is None
    data = training.centred.data
    alone = LinearRegression().fit(data.X, data.Y)
    np.testing.assert_allclose(models[4].estimator.predict(data.X), alone.predict(data.X), rtol=0, atol=1e-9)
    assert models[5].estimator.cameras_[0].lens == "brown5"


@pytest.mark.slow
def test_an_installed_command_finds_a_module_in_the_folder_where_it_is_given(
    shoot: Shoot, dots: Detections, tmp_path: Path
) -> None:
    (tmp_path / "users_regression.py").write_text(CODE)
    (tmp_path / "json.py").write_text("raise RuntimeError('stands in for nothing')\n")
    (tmp_path / "dots.csv").write_text(detections_csv(dots))
    script = tmp_path / "bin" / "labcal.py"
    script.parent.mkdir()
    script.write_text("import sys\nfrom labcal.cli import main\nsys.exit(main())\n")
    words = ["fit", shoot.folder, "--method", OWN, "--detections", "dots.csv", "--no-rehearsal", "-o", "m"]
    package = str(Path(pipeline.__file__).parents[2])
    done = subprocess.run(
        [sys.executable, "-P", str(script), *map(str, words)],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": package},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "m").is_file()


def _target(shoot: Shoot, folder: Path) -> Path:
    path = folder / "target.yaml"
    path.write_text(shoot.target.model_dump_json())
    return path
