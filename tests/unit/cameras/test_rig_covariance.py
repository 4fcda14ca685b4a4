"""The joint covariance in rig.json: read back as it was, refused where it is none or of other cameras."""

import json
from pathlib import Path

import numpy as np
import pytest

from labcal import InputError, Rig, examples, read_rig
from labcal.cameras.interop.rig_files import chosen_cameras
from labcal.cameras.rig_covariance import RigCovariance, parameter_names

COUNT = len(parameter_names(examples.rig().cameras))


def rig() -> Rig:
    plain = examples.rig()
    root = np.random.default_rng(0).standard_normal((COUNT, COUNT))
    return plain.model_copy(update={"covariance": RigCovariance.of(plain.cameras, root @ root.T)})


def test_it_is_read_back_as_it_was(tmp_path: Path) -> None:
    rig().save(tmp_path / "rig.json")
    assert read_rig(tmp_path / "rig.json") == rig()
    assert rig() != examples.rig()


def test_the_matrix_is_symmetric_with_the_variances_on_its_diagonal() -> None:
    stated = rig().covariance
    assert stated is not None
    np.testing.assert_array_equal(stated.matrix, stated.matrix.T)
    assert [row[-1] for row in stated.lower] == np.diagonal(stated.matrix).tolist()


def test_older_files_have_none(tmp_path: Path) -> None:
    examples.rig().save(tmp_path / "rig.json")
    assert "covariance" not in (tmp_path / "rig.json").read_text()
    assert read_rig(tmp_path / "rig.json").covariance is None


def spoiled(document: dict[str, object], tmp_path: Path) -> Path:
    path = tmp_path / "rig.json"
    path.write_text(json.dumps(document))
    return path


def test_what_is_no_covariance_is_refused(tmp_path: Path) -> None:
    for row, value, said in (
        (0, -1.0, "negative variance"),
        (1, 1e9, "negative variance"),
        (2, None, "number"),
    ):
        document = json.loads(rig().model_dump_json())
        document["covariance"]["lower"][row][0] = value
        with pytest.raises(InputError, match=said):
            read_rig(spoiled(document, tmp_path))
    document = json.loads(rig().model_dump_json())
    document["covariance"]["lower"].pop()
    with pytest.raises(InputError, match="rows of a lower triangle"):
        read_rig(spoiled(document, tmp_path))


def test_that_of_other_cameras_is_refused(tmp_path: Path) -> None:
    document = json.loads(rig().model_dump_json())
    document["cameras"] = dict(reversed(document["cameras"].items()))
    with pytest.raises(InputError, match=r"'left\.fx' where 'right\.fx' is expected"):
        read_rig(spoiled(document, tmp_path))
    document = json.loads(rig().model_dump_json())
    del document["cameras"]["right"]
    with pytest.raises(InputError, match="24 parameters, but its cameras 9"):
        read_rig(spoiled(document, tmp_path))


def test_a_part_of_the_cameras_has_none() -> None:
    assert chosen_cameras(rig(), ["left", "right"]).covariance == rig().covariance
    assert chosen_cameras(rig(), ["right", "left"]).covariance is None
    assert chosen_cameras(rig(), ["right"]).covariance is None
