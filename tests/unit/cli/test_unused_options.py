"""An option that would be dropped is an error, in every verb."""

from pathlib import Path

import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.cli import main
from labcal.correspond.points_csv import HEADER
from labcal.shoot.dataset import write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest, Role, ViewEntry
from labcal.targets.catalogue import load_target

TARGET = "paper-13x10"


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with inputs that are looked at after the options are."""
    monkeypatch.chdir(tmp_path)
    Path("shoot").mkdir()
    view = ViewEntry(
        name="a", images={"left": "images/a_left.png"}, role=Role.TEST, T_world_target_nominal=None
    )
    cameras = {"left": CameraEntry(size=(640, 480))}
    write_manifest(Path("shoot"), Manifest(target=load_target(TARGET), cameras=cameras, views=(view,)))
    for name in ("dots.csv", "points.csv", "a_0.png", "corners.vnl", "model"):
        Path(name).write_text("")
    Path("points.csv").write_text(",".join(HEADER) + "\n")
    K = np.array([[700.0, 0.0, 320.0], [0.0, 700.0, 240.0], [0.0, 0.0, 1.0]])
    camera = Camera(K, "pinhole", np.zeros(5), np.eye(4), (640, 480))
    Path("rig.json").write_text(Rig.of({"left": camera}).model_dump_json())
    return tmp_path


@pytest.mark.parametrize(
    ("words", "option"),
    [
        ("detect shoot -o d.csv --cameras _0=left", "--cameras is for loose pictures"),
        ("inspect shoot -o sheet.png --cameras _0=left", "--cameras is for loose pictures"),
        ("undistort rig.json shoot -o flat --cameras _0=left", "--cameras is for loose pictures"),
        ("undistort rig.json a_0.png -o flat --rectify --whole", "--whole is what --rectify does"),
        (
            "undistort rig.json a_0.png -o flat --cameras _0=left --distance-mm 500",
            "--distance-mm is for a lens prescription",
        ),
        (f"calibrate dots.csv --target {TARGET} -o r.json --workers 2", "--workers is for finding dots"),
        ("calibrate shoot -o r.json --keep-dots --overlay arrows.png", "these dots are kept"),
        ("reconstruct rig.json dots.csv -o p.csv --workers 2", "--workers is for finding dots"),
        (f"fit dots.csv --target {TARGET} --method affine -o m --workers 2", "--workers is for finding dots"),
        ("fit shoot --method affine --detections dots.csv -o m --workers 2", "--workers is for finding dots"),
        ("fit shoot --method affine,dlt --no-rehearsal --seed 0 -o m", "--seed means nothing to affine,dlt"),
        (f"evaluate points.csv --target {TARGET} --detections dots.csv", "--detections goes with the truth"),
        ("evaluate points.csv shoot --alignment rigid", "--alignment goes with the truth"),
        ("convert rig.json other.json --target rings-10x8", "--target goes with detections"),
        ("convert rig.json other.json --cameras _0=left", "--cameras goes with detections"),
        (
            "convert rig.json other.json --size 640x480",
            "--size does not apply to files of the format 'labcal'",
        ),
        ("convert rig.json other.json --unit m", "--unit does not apply to files of the format 'labcal'"),
        (
            "convert rig.json other.json --lens brown5",
            "--lens does not apply to files of the format 'labcal'",
        ),
        (
            f"convert dots.csv new.vnl --target {TARGET} --size 640x480",
            "--size does not apply to .csv as input",
        ),
        (f"convert dots.csv new.vnl --target {TARGET} --cameras _0=left", "--cameras does not apply to .csv"),
        (f"convert dots.csv new.vnl --target {TARGET} --from opencv", "--from goes with cameras"),
        (f"convert dots.csv new.vnl --target {TARGET} --unit m", "--unit goes with cameras"),
        (f"convert corners.vnl d.csv --target {TARGET} --to labcal", "--to goes with cameras"),
        (
            f"convert corners.vnl d.csv --target {TARGET} --only left",
            "--only does not apply to .vnl as input",
        ),
        ("bench render --only suite -o out", "--only names groups"),
        ("bench detect --method mlp -o out", "--method goes with 'bench solve'"),
        ("bench solve --detections shoot -o out", "--detections goes with 'bench distortion'"),
        ("target export rings-10x8 -o target.svg --dpi 300", "dpi"),
    ],
)
def test_it_is_refused_by_name(
    home: Path, capsys: pytest.CaptureFixture[str], words: str, option: str
) -> None:
    before = sorted(path.name for path in home.iterdir())
    assert main(words.split()) == 2
    assert option in capsys.readouterr().err
    assert sorted(path.name for path in home.iterdir()) == before


def test_a_seed_of_its_own_value_is_told_from_the_default(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Zero is what is taken where none is given."""
    words = "fit shoot --method mlp --no-rehearsal --seed 0 -o m"
    assert main(words.split()) == 2  # for the damaged shoot
    assert "--seed" not in capsys.readouterr().err
    assert not (home / "m").exists()
