"""Folders that other code began, or an earlier version, or that it had finished."""

from pathlib import Path

import pytest

from labcal.errors import OutputError
from labcal.run.begun import COMMAND, Begun
from labcal.run.made import MADE
from labcal.run.outputs import write_file
from labcal.run.unfinished import unfinished_folder


def entries(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def refuse(target: Path, said: str) -> None:
    with pytest.raises(OutputError, match=said), unfinished_folder(target, "render", force=False):
        pytest.fail("the work has begun")


def work_until_interrupted(target: Path) -> None:
    with unfinished_folder(target, "render", force=False) as working:
        write_file(working / "a.txt", "1", force=True)
        raise KeyboardInterrupt


def begun_by(target: Path, begun: Begun) -> None:
    """Leave an unfinished folder as other code would."""
    with pytest.raises(KeyboardInterrupt):
        work_until_interrupted(target)
    (target.with_name("shoot.unfinished") / COMMAND).write_text(begun.text())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"version": "0.0.9"}, "was begun by labcal 0.0.9 "),
        (
            {"code_sha256": "ab" * 32},
            r"begun by labcal .* \(code abababab\), but .*`force=True`",
        ),
    ],
)
def test_what_other_code_began_is_refused_and_discarded_only_with_force(
    tmp_path: Path, change: dict[str, str], said: str
) -> None:
    target = tmp_path / "shoot"
    begun_by(target, Begun.now("render").model_copy(update=change))
    refuse(target, said)
    assert (tmp_path / "shoot.unfinished" / "a.txt").exists()
    with unfinished_folder(target, "render", force=True) as working:
        assert not (working / "a.txt").exists()
        write_file(working / "b.txt", "2", force=True)
    assert entries(target) == [MADE, "b.txt"]


def test_what_an_earlier_version_left_is_refused_as_that(tmp_path: Path) -> None:
    """It wrote the command alone."""
    target = tmp_path / "shoot"
    begun_by(target, Begun.now("render"))
    (tmp_path / "shoot.unfinished" / COMMAND).write_text("render")
    refuse(target, "was begun by an earlier version of labcal")


def test_what_other_code_has_finished_is_not_taken_up_again(tmp_path: Path) -> None:
    target = tmp_path / "shoot"
    with unfinished_folder(target, "render", force=False) as working:
        write_file(working / "a.txt", "1", force=True)
    others = Begun.now("render").model_copy(update={"version": "0.0.9"})
    (target / COMMAND).write_text(others.text())  # killed when all was done but for removing the mark
    refuse(target, "exists already")
    assert entries(tmp_path) == ["shoot"]
