"""mrcal's own programs read labcal's camera models, and labcal reads theirs."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from labcal.bench.solve.mrcal_programs import is_installed, module_run, projected, reprojected
from labcal.cameras.interop.mrcal import write_mrcal
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.cameras.rig import Rig
from labcal.errors import InputError

MakeRig = Callable[..., Rig]
needs_mrcal = pytest.mark.skipif(not is_installed(), reason="mrcal is not installed")
LENSES = ("pinhole", "brown-k1k2", "brown5", "rational8", "thin-prism12")


@needs_mrcal
@pytest.mark.parametrize("lens", LENSES)
def test_mrcal_projects_alike(
    lens: str, tmp_path: Path, make_rig: MakeRig, elsewhere: np.ndarray, points: np.ndarray
) -> None:
    rig = make_rig(lens, elsewhere)
    in_world = (points - elsewhere[:3, 3]) @ elsewhere[:3, :3]
    for file in write_mrcal(rig, ".cameramodel").files:
        path = tmp_path / f"{file.label}.cameramodel"
        path.write_text(file.text)
        seen = rig.camera(file.label).project(in_world)
        assert seen.ok.sum() > 100
        np.testing.assert_allclose(projected(path, in_world)[seen.ok], seen.q[seen.ok], rtol=0.0, atol=1e-8)


@needs_mrcal
def test_a_program_of_mrcal_projects_alike(tmp_path: Path, make_rig: MakeRig, points: np.ndarray) -> None:
    rig = make_rig("rational8", count=1)
    path = tmp_path / "left.cameramodel"
    path.write_text(write_mrcal(rig, ".cameramodel").files[0].text)
    np.testing.assert_allclose(reprojected(path, points), rig.camera("left").project(points).q, atol=6e-7)


@needs_mrcal
def test_what_mrcal_writes_is_read(tmp_path: Path, make_rig: MakeRig, elsewhere: np.ndarray) -> None:
    rig = make_rig("rational8", elsewhere, 1)
    ours, theirs = tmp_path / "ours.cameramodel", tmp_path / "theirs.cameramodel"
    ours.write_text(write_mrcal(rig, ".cameramodel").files[0].text)
    module_run("import mrcal, sys; mrcal.cameramodel(sys.argv[1]).write(sys.argv[2])", [ours, theirs])
    assert "# camera:" not in theirs.read_text()
    _, read = read_rig_files([theirs], None)
    record, meant = read.rig.cameras["theirs"], rig.cameras["left"]
    assert record.lens == "rational8"
    np.testing.assert_allclose(record.K, meant.K, rtol=1e-9)  # mrcal writes ten digits
    np.testing.assert_allclose(record.dist, meant.dist, rtol=1e-9)
    np.testing.assert_allclose(record.T_cam_world, meant.T_cam_world, rtol=1e-8, atol=1e-8)


def test_translations_are_in_metres_and_the_newer_key_is_read(tmp_path: Path, make_rig: MakeRig) -> None:
    text = write_mrcal(make_rig("pinhole"), ".cameramodel").files[1].text
    written = np.array(text.partition("'extrinsics': [")[2].partition("]")[0].split(","), dtype=np.float64)
    np.testing.assert_allclose(written[3:], [-0.1803, 0.0061, 0.0257], rtol=1e-14)
    path = tmp_path / "camera.cameramodel"
    path.write_text(text.replace("'extrinsics'", "'rt_cam_ref'"))
    record = read_rig_files([path], None)[1].rig.cameras["right-2"]
    np.testing.assert_allclose(np.array(record.T_cam_world)[:3, 3], [-180.3, 6.1, 25.7], rtol=1e-14)


@pytest.mark.parametrize(
    "model", ["LENSMODEL_CAHVOR", "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=20_fov_x_deg=170"]
)
def test_other_lens_models_are_refused_by_name(tmp_path: Path, make_rig: MakeRig, model: str) -> None:
    path = tmp_path / "camera.cameramodel"
    path.write_text(
        write_mrcal(make_rig("pinhole", count=1), ".cameramodel")
        .files[0]
        .text.replace("LENSMODEL_PINHOLE", model)
    )
    with pytest.raises(InputError, match=f"the lens model '{model[:40]}"):
        read_rig_files([path], None)


def test_nothing_in_a_model_is_run(tmp_path: Path) -> None:
    path = tmp_path / "camera.cameramodel"
    proof = tmp_path / "proof"
    path.write_text(f"{{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': open({str(proof)!r}, 'w')}}")
    with pytest.raises(InputError, match="is not a camera model"):
        read_rig_files([path], None)
    assert not proof.exists()
