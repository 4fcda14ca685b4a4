import errno
import multiprocessing
import os
import stat
from collections.abc import Callable
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import NoReturn

import pytest

from labcal.errors import DiskFullError, OutputError
from labcal.run.begun import COMMAND, Begun
from labcal.run.foreign import foreign_entries
from labcal.run.made import ASIDE, JOURNAL, MADE, SCRAP, made_in, make_folder, provenance_text
from labcal.run.moved_aside import recover
from labcal.run.outputs import write_file
from labcal.run.unfinished import abandon, unfinished_folder


@pytest.fixture(autouse=True)
def quick_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wait for no disk: ``test_durable.py`` looks at that."""
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)  # noqa: ARG005 - its form


def entries(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def made(target: Path, text: str = "1", command: str = "render", *, force: bool = False) -> Path:
    """Make a folder with a file and a folder in it."""
    with unfinished_folder(target, command, force=force) as working:
        write_file(working / "a.txt", text, force=True)
        (working / "images").mkdir(exist_ok=True)
        write_file(working / "images" / "b.png", text, force=True)
    return target


def work_until_interrupted(target: Path, command: str, *, force: bool = False) -> None:
    with unfinished_folder(target, command, force=force) as working:
        write_file(working / "a.txt", "1", force=True)
        raise KeyboardInterrupt


def refuse(target: Path, said: str, command: str = "render", *, force: bool = True) -> None:
    with pytest.raises(OutputError, match=said), unfinished_folder(target, command, force=force):
        pytest.fail("the work has begun")


def test_a_folder_appears_when_the_work_ends_well(tmp_path: Path) -> None:
    target = tmp_path / "out" / "shoot"
    with unfinished_folder(target, "render", force=False) as working:
        write_file(working / "a.txt", "1", force=True)
        assert not target.exists()
    assert entries(target) == [MADE, "a.txt"]
    assert entries(target.parent) == ["shoot"]


def test_the_mark_says_who_made_what_and_is_the_same_each_time(tmp_path: Path) -> None:
    for name in ("one", "two"):
        with unfinished_folder(tmp_path / name, "bench detect True 0", force=False) as working:
            for file in ("b.txt", "a.txt") if name == "one" else ("a.txt", "b.txt", "a.txt"):
                write_file(working / file, file, force=True)
            times = provenance_text({"seconds": 1.5 if name == "one" else 2.5})  # they always differ
            write_file(working / "run.json", times, force=True)
    assert (tmp_path / "one" / MADE).read_bytes() == (tmp_path / "two" / MADE).read_bytes()
    mark = made_in(tmp_path / "one")
    assert mark is not None
    assert mark.made_by == "bench"
    assert list(mark.files) == ["a.txt", "b.txt", "run.json"]
    assert mark.files["run.json"] is None


def test_interrupted_work_resumes_where_the_same_command_left_it(tmp_path: Path) -> None:
    target = tmp_path / "shoot"
    with pytest.raises(KeyboardInterrupt):
        work_until_interrupted(target, "render --spp 4")
    assert not target.exists()
    with unfinished_folder(target, "render --spp 4", force=False) as working:
        assert (working / "a.txt").read_text() == "1"
        write_file(working / "b.txt", "2", force=True)
    assert entries(target) == [MADE, "a.txt", "b.txt"]
    made(target, "new", force=True)  # what the first run wrote counts as made, too
    assert entries(target) == [MADE, "a.txt", "images"]


def test_what_a_killed_worker_was_writing_is_not_in_the_result(tmp_path: Path) -> None:
    target = tmp_path / "shoot"
    with unfinished_folder(target, "render", force=False) as working:
        (working / "images").mkdir()
        (working / "images" / f"{SCRAP}k3j2").write_text("half")
        write_file(working / "images" / "a.png", "whole", force=False)
    assert [path.name for path in (target / "images").iterdir()] == ["a.png"]


def test_what_another_command_left_is_refused_and_discarded_only_with_force(tmp_path: Path) -> None:
    target = tmp_path / "shoot"
    with pytest.raises(KeyboardInterrupt):
        work_until_interrupted(target, "render --spp 4")
    refuse(target, "another command", "render --spp 8", force=False)
    assert (tmp_path / "shoot.unfinished" / "a.txt").exists()
    with unfinished_folder(target, "render --spp 8", force=True) as working:
        assert entries(working) == [COMMAND, JOURNAL] or entries(working) == [COMMAND]
    assert entries(target) == [MADE]


@pytest.mark.parametrize("name", ["thesis.txt", ".hidden", "images/thesis.txt", "empty/"])
def test_an_unfinished_folder_with_anything_else_in_it_is_not_discarded(tmp_path: Path, name: str) -> None:
    target, working = tmp_path / "shoot", tmp_path / "shoot.unfinished"
    with pytest.raises(KeyboardInterrupt):
        work_until_interrupted(target, "render --spp 4")
    (working / "images").mkdir()
    write_file(working / "images" / "b.png", "1", force=True)
    if name.endswith("/"):
        (working / name).mkdir()
    else:
        (working / name).write_text("mine")
    refuse(target, name, "render --spp 8")
    assert (working / name).exists()
    # The same command goes on in it, and what is not its own stays there, and keeps it from being replaced.
    made(target, command="render --spp 4")
    refuse(target, name, "render --spp 4")
    assert (target / name).exists()


def test_folders_for_files_and_torn_lists_count_as_made(tmp_path: Path) -> None:
    target, working = tmp_path / "shoot", tmp_path / "shoot.unfinished"

    def begin() -> None:
        with unfinished_folder(target, "render", force=False) as here:
            make_folder(here / "images")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        begin()
    with unfinished_folder(target, "another", force=True) as here:  # nothing has been written in images yet
        make_folder(here / "maps")
    assert entries(target) == [MADE, "maps"]
    with pytest.raises(KeyboardInterrupt):
        work_until_interrupted(target, "render", force=True)
    with (working / JOURNAL).open("a") as handle:
        handle.write('{"file": "b.t')  # the power failed
    with unfinished_folder(target, "render", force=True) as here:
        write_file(here / "b.txt", "2", force=True)
    made(target, force=True)
    assert entries(target) == [MADE, "a.txt", "images"]


def test_work_does_not_go_on_through_a_link(tmp_path: Path) -> None:
    target, mine = tmp_path / "shoot", tmp_path / "mine"
    with pytest.raises(KeyboardInterrupt):
        work_until_interrupted(target, "render")
    mine.mkdir()
    lay(mine / "a.png")
    (tmp_path / "shoot.unfinished" / "images").symlink_to("../mine")
    for force in (False, True):
        refuse(target, "images in it is a link", force=force)
    assert (mine / "a.png").read_text() == "mine"


@pytest.mark.parametrize("kind", ["folder", "file", "link"])
def test_what_has_the_name_of_an_unfinished_folder_but_no_mark_stays(tmp_path: Path, kind: str) -> None:
    working = tmp_path / "shoot.unfinished"
    if kind == "folder":
        working.mkdir()
        (working / ".command").write_text("render")  # an older version's
    elif kind == "file":
        working.write_text("mine")
    else:
        (tmp_path / "elsewhere").mkdir()
        working.symlink_to("elsewhere")
    for force in (False, True):
        refuse(tmp_path / "shoot", "no unfinished output", force=force)
    assert os.path.lexists(working)
    assert not (tmp_path / "shoot").exists()


def test_a_run_killed_at_any_moment_goes_on(tmp_path: Path) -> None:
    target, working = tmp_path / "shoot", tmp_path / "shoot.unfinished"
    working.mkdir()  # killed before the folder was marked
    (working / ".labcal-part-command").write_text("ren")  # or while it was
    with pytest.raises(KeyboardInterrupt):
        work_until_interrupted(target, "render")
    (working / "images").mkdir()
    (working / "images" / ".labcal-part-xyz").write_text("half a picture")
    (working / "images" / ".mine").write_text("a hidden file of somebody else's")
    with unfinished_folder(target, "render", force=False) as again:
        assert sorted(path.name for path in again.rglob("*")) == [
            COMMAND, JOURNAL, ".mine", "a.txt", "images",
        ]  # fmt: skip
    assert entries(target) == [MADE, "a.txt", "images"]
    # Killed when all was done but for removing the mark.
    (target / COMMAND).write_text(Begun.now("render").text())
    refuse(target, "`force=True`", "other", force=False)
    with unfinished_folder(target, "render", force=False) as again:
        assert again == working
        assert not target.exists()
    assert entries(target) == [MADE, "a.txt", "images"]
    refuse(target, "`force=True`", force=False)


def test_a_folder_that_labcal_made_is_kept_until_its_successor_is_whole(tmp_path: Path) -> None:
    target = made(tmp_path / "shoot", "old")
    refuse(target, "`force=True`", force=False)
    with unfinished_folder(target, "render", force=True) as working:
        write_file(working / "new.txt", "new", force=True)
        assert entries(target) == [MADE, "a.txt", "images"]
    assert entries(target) == [MADE, "new.txt"]
    assert entries(tmp_path) == ["shoot"]


def lay(path: Path) -> None:
    path.write_text("mine")


FOREIGN: dict[str, Callable[[Path], object]] = {
    "a file": lambda target: lay(target / "thesis.txt"),
    "a hidden file": lambda target: lay(target / ".git"),
    "a file further down": lambda target: lay(target / "images" / "c.png"),
    "a folder": lambda target: (target / "mine").mkdir(),
    "a link": lambda target: (target / "link").symlink_to("a.txt"),
    "a dangling link": lambda target: (target / "images" / "link").symlink_to("nowhere"),
    "a pipe": lambda target: os.mkfifo(target / "pipe"),
    "a changed file": lambda target: lay(target / "a.txt"),
    "a file that became a link": lambda target: (
        (target / "a.txt").rename(target.parent / "a.txt"),
        (target / "a.txt").symlink_to("../a.txt"),
    ),
    "a folder that became a link": lambda target: (
        (target / "images").rename(target.parent / "images"),
        (target / "images").symlink_to("../images"),
    ),
    "a protected file": lambda target: (target / "a.txt").chmod(0o444),
    "a protected folder inside": lambda target: (target / "images").chmod(0o555),
    "a protected folder": lambda target: target.chmod(0o555),
    "another folder of labcal's": lambda target: made(target / "images" / "other"),
    "no mark": lambda target: (target / MADE).unlink(),
    "a damaged mark": lambda target: (target / MADE).write_text("{"),
    "a mark that is a link": lambda target: (
        (target / MADE).rename(target.parent / "mark"),
        (target / MADE).symlink_to("../mark"),
    ),
}


def snapshot(folder: Path) -> dict[str, tuple[int, bytes | str]]:
    """Return everything below a folder: kind and rights, and what is in it."""
    found: dict[str, tuple[int, bytes | str]] = {}
    for home, folders, files in os.walk(folder):
        for path in (Path(home, name) for name in (*folders, *files)):
            mode = path.lstat().st_mode
            content: bytes | str = ""
            if stat.S_ISLNK(mode):
                content = os.readlink(path)  # noqa: PTH115 -- the same text
            elif stat.S_ISREG(mode):
                content = path.read_bytes()
            found[path.relative_to(folder).as_posix()] = (mode, content)
    return found


@pytest.mark.parametrize("what", FOREIGN)
def test_a_folder_that_holds_anything_else_is_not_replaced(tmp_path: Path, what: str) -> None:
    target = made(tmp_path / "shoot")
    FOREIGN[what](target)
    before = snapshot(tmp_path)
    refuse(target, "is not replaced")
    assert snapshot(tmp_path) == before
    target.chmod(0o755)  # so that the tests may clean up


def test_what_was_removed_from_a_folder_does_not_matter(tmp_path: Path) -> None:
    target = made(tmp_path / "shoot")
    (target / "images" / "b.png").unlink()
    made(target, "new", force=True)
    assert (target / "a.txt").read_text() == "new"
    (tmp_path / "empty").mkdir()
    made(tmp_path / "empty", force=True)


def test_what_gets_into_a_folder_while_its_successor_is_made_stops_the_replacement(tmp_path: Path) -> None:
    target = made(tmp_path / "shoot", "old")

    def work() -> None:
        with unfinished_folder(target, "render", force=True) as working:
            write_file(working / "a.txt", "new", force=True)
            lay(target / "late.txt")

    with pytest.raises(OutputError, match=r"late\.txt"):
        work()
    assert entries(target) == [MADE, "a.txt", "images", "late.txt"]
    assert (target / "a.txt").read_text() == "old"
    (target / "late.txt").unlink()
    with unfinished_folder(target, "render", force=True) as working:  # the work is not lost
        assert (working / "a.txt").read_text() == "new"
    assert (target / "a.txt").read_text() == "new"
    assert entries(tmp_path) == ["shoot"]


def test_finished_folders_inside_belong_to_the_whole(tmp_path: Path) -> None:
    target = tmp_path / "out"
    for force in (False, True):
        with unfinished_folder(target, "reproduce", force=force) as working:
            made(working / "shoots" / "a")
            with pytest.raises(KeyboardInterrupt):
                work_until_interrupted(working / "shoots" / "b", "render")
            made(working / "shoots" / "b")
        assert entries(target / "shoots") == ["a", "b"]
    with pytest.raises(KeyboardInterrupt), unfinished_folder(target, "reproduce 2", force=True) as working:
        work_until_interrupted(working / "shoots" / "a", "render")
    made(target, "new", force=True)  # discards that one, and replaces the other
    assert entries(tmp_path) == ["out"]
    assert entries(target) == [MADE, "a.txt", "images"]


class Killed(BaseException):
    """The process ends here."""


STEPS = 13
"""Renamings and removals while a folder is replaced."""


@pytest.mark.parametrize("step", range(STEPS + 1))
def test_a_replacement_killed_at_any_step_is_finished_by_the_next_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: int
) -> None:
    target = made(tmp_path / "shoot", "old")
    steps = 0

    def counted(function: Callable[..., object]) -> Callable[..., object]:
        def call(*args: object, **options: object) -> object:
            nonlocal steps
            if armed and steps >= step:
                raise Killed  # and every later step, too: nothing is tidied up after a kill
            steps += armed
            return function(*args, **options)

        return call

    armed = False
    for name in ("rename", "replace", "unlink", "rmdir"):
        monkeypatch.setattr(os, name, counted(getattr(os, name)))
    killed = False
    try:
        with unfinished_folder(target, "render", force=True) as working:
            write_file(working / "c.txt", "new", force=True)
            armed = True
    except Killed:
        killed = True
    monkeypatch.undo()
    assert killed == (step < STEPS)
    left = snapshot(tmp_path)
    held = [left.get(f"{name}/a.txt", (0, ""))[1] for name in ("shoot", "shoot.labcal-old")]
    new = [f"{name}/c.txt" in left for name in ("shoot", "shoot.unfinished")]
    assert any(new)
    assert b"old" in held or "shoot/c.txt" in left
    with unfinished_folder(target, "render", force=True) as working:
        assert not (working / "a.txt").exists()
        write_file(working / "c.txt", "new", force=True)
    assert entries(target) == [MADE, "c.txt"]
    assert entries(tmp_path) == ["shoot"]


def test_a_replacement_that_fails_or_is_interrupted_puts_the_old_folder_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = made(tmp_path / "shoot", "old")
    before = snapshot(target)
    rename = Path.rename

    for error in (OSError(errno.EIO, "Input/output error"), KeyboardInterrupt()):

        def failing(path: Path, new: Path, error: BaseException = error) -> Path:
            if new == target and path.name == "shoot.unfinished":
                raise error
            return rename(path, new)

        monkeypatch.setattr(Path, "rename", failing)
        with pytest.raises((OutputError, KeyboardInterrupt)):
            made(target, "new", force=True)
        monkeypatch.setattr(Path, "rename", rename)
        assert snapshot(target) == before
        assert entries(tmp_path) == ["shoot", "shoot.unfinished"]
    made(target, "new", force=True)
    assert entries(tmp_path) == ["shoot"]


def hold(target: Path, begun: Event, done: Event) -> None:
    with unfinished_folder(target, "render", force=False) as working:
        write_file(working / "a.txt", "first", force=True)
        begun.set()
        done.wait(60)


@pytest.mark.skipif(os.name == "nt", reason="no locks there")
def test_two_processes_do_not_work_in_the_same_folder(tmp_path: Path) -> None:
    context = multiprocessing.get_context("fork")
    begun, done = context.Event(), context.Event()
    other = context.Process(target=hold, args=(tmp_path / "shoot", begun, done))
    other.start()
    assert begun.wait(60)
    for command in ("render", "another"):
        refuse(tmp_path / "shoot", "Another labcal process works", command)
    old = made(tmp_path / "old").rename(tmp_path / "shoot.labcal-old")
    (old / ASIDE).write_text("shoot")  # as while the other one is putting its folder in its place
    recover(tmp_path / "shoot")
    assert old.is_dir()
    done.set()
    other.join(60)
    assert other.exitcode == 0
    assert (tmp_path / "shoot" / "a.txt").read_text() == "first"
    assert old.is_dir()


def test_what_is_of_use_to_nobody_is_removed_and_nothing_else(tmp_path: Path) -> None:
    def work(*, mine: bool) -> None:
        with unfinished_folder(tmp_path / f"out-{mine}", "undistort", force=False) as working:
            write_file(working / "a.txt", "1", force=True)
            if mine:
                lay(working / "mine.txt")
            abandon(working)
            raise OutputError("nothing usable")

    for mine in (False, True):
        with pytest.raises(OutputError, match="nothing usable"):
            work(mine=mine)
    assert entries(tmp_path) == ["out-True.unfinished"]
    assert entries(tmp_path / "out-True.unfinished") == [COMMAND, JOURNAL, "mine.txt"]


def test_a_folder_that_cannot_be_made_is_an_output_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    refuse(tmp_path / "file" / "x", "file", force=False)
    refuse(tmp_path / ("x" * 250), "too long")


def test_a_full_disk_in_the_work_is_told_as_such(tmp_path: Path) -> None:
    def work() -> NoReturn:
        with unfinished_folder(tmp_path / "shoot", "c", force=False):
            raise OSError(errno.ENOSPC, "No space left on device")

    with pytest.raises(DiskFullError):
        work()
    assert not (tmp_path / "shoot").exists()


def test_the_gallery_in_the_documents_can_be_made_again() -> None:
    """`labcal scene gallery -o docs/gallery --force`, as its page says."""
    gallery = Path(__file__).parents[3] / "docs" / "gallery"
    assert foreign_entries(gallery) == []


def test_of_two_commands_that_begin_at_once_one_has_the_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other one marks the folder between the look for a mark and the mark."""
    mark = tmp_path / "shoot.unfinished" / COMMAND

    def meanwhile(_scrap: Path) -> None:
        if not mark.exists():
            mark.write_text("render another")

    monkeypatch.setattr("labcal.run.unfinished.flush_file", meanwhile)
    refuse(tmp_path / "shoot", "Another labcal process works", "render one", force=False)
    assert mark.read_text() == "render another"
    assert entries(mark.parent) == [COMMAND]
