import json
from pathlib import Path

from labcal.run.made import JOURNAL, digest_of, is_as_made, mark_as_made
from labcal.shoot.dataset import MANIFEST, Shoot, write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest
from labcal.targets.catalogue import load_target


def manifest(number: int | None) -> Manifest:
    cameras = {"left": CameraEntry(size=(64, 48))}
    return Manifest(target=load_target("rings-14x10"), print_number=number, cameras=cameras, views=())


def made(folder: Path) -> None:
    write_manifest(folder, manifest(2))
    note = {"file": MANIFEST, "sha256": digest_of(folder / MANIFEST)}
    (folder / JOURNAL).write_text(json.dumps(note) + "\n")
    mark_as_made(folder, "capture")
    assert is_as_made(folder / MANIFEST)


def test_a_rewritten_manifest_is_still_labcal_s_own(tmp_path: Path) -> None:
    made(tmp_path)
    scaled = Shoot(tmp_path, manifest(2)).with_print_scale("99.8/100")
    write_manifest(tmp_path, scaled.manifest)
    assert is_as_made(tmp_path / MANIFEST)
    assert scaled.manifest.print_number == 2


def test_a_manifest_that_was_changed_by_hand_stays_foreign(tmp_path: Path) -> None:
    made(tmp_path)
    (tmp_path / MANIFEST).write_text("{}")
    write_manifest(tmp_path, manifest(None))
    assert not is_as_made(tmp_path / MANIFEST)
    assert "print_number" not in (tmp_path / MANIFEST).read_text()


def test_another_target_has_no_number(tmp_path: Path) -> None:
    assert Shoot(tmp_path, manifest(2)).showing("plain-11x8").manifest.print_number is None
