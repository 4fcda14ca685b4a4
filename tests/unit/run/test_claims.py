"""Outputs in every arrangement that a command line may make by mistake, checked before any work is done."""

import os
import socket
import stat
from pathlib import Path

import pytest

from labcal.errors import OutputError
from labcal.run import mounts, overwriting
from labcal.run.begun import COMMAND
from labcal.run.claims import FileOutput, FolderOutput, claim_outputs
from labcal.run.file_kinds import beginning_with, recognised_by
from labcal.run.outputs import write_file
from labcal.run.unfinished import unfinished_folder

TABLE = beginning_with("a table", b"view,")


@pytest.fixture(autouse=True)
def quick_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wait for no disk: ``test_durable.py`` looks at that."""
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)  # noqa: ARG005 - its form


def made(folder: Path) -> Path:
    with unfinished_folder(folder, "render", force=False) as working:
        (working / "images").mkdir()
        write_file(working / "a", "1", force=True)
        write_file(working / "images" / "a.png", "1", force=True)
    return folder


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a shoot, tables and things of the user's; the current one."""
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    made(here / "shoot")
    made(here / "other")
    (here / "table.csv").write_text("view,camera\n1,left\n")
    (here / "thesis.txt").write_text("years of work")
    (here / "photos").mkdir()
    (here / "photos" / "a.png").write_bytes(b"\x89PNG...")
    (here / "photo.jpg").write_bytes(b"\xff\xd8\xff...")
    (here / "empty.csv").write_bytes(b"")
    (here / "link").symlink_to("shoot")
    (here / "link.csv").symlink_to("table.csv")
    (here / "dangling").symlink_to("nowhere")
    os.link(here / "table.csv", here / "hard.csv")
    os.mkfifo(here / "pipe")
    (here / "protected.csv").write_text("view,")
    (here / "protected.csv").chmod(0o444)
    return here


def snapshot(folder: Path) -> dict[str, tuple[int, bytes | str]]:
    found: dict[str, tuple[int, bytes | str]] = {}
    for root, folders, files in os.walk(folder):
        for path in (Path(root, name) for name in (*folders, *files)):
            mode = path.lstat().st_mode
            link = os.readlink(path) if stat.S_ISLNK(mode) else ""  # noqa: PTH115 -- the same text
            found[str(path)] = (mode, path.read_bytes() if stat.S_ISREG(mode) else link)
    return found


def refuse(said: str, outputs: list[FileOutput | FolderOutput], *inputs: str) -> None:
    with pytest.raises(OutputError, match=said):
        claim_outputs(outputs, inputs, force=True)


def table(name: str) -> FileOutput:
    return FileOutput(Path(name), TABLE)


def folder(name: str) -> FolderOutput:
    return FolderOutput(Path(name))


FILES = {
    "an input": ("table.csv", ["table.csv"], "an input of this command"),
    "an input by another path": ("../here/./table.csv", ["table.csv"], "an input of this command"),
    "a hard link to an input": ("hard.csv", ["table.csv"], "an input of this command"),
    "a link to an input": ("link.csv", ["table.csv"], "an input of this command"),
    "an input that was given by a link": ("table.csv", ["link.csv"], "an input of this command"),
    "an input through a folder that is a link": ("link/a", ["shoot/a"], "an input of this command"),
    "a link": ("link.csv", [], "A link is not replaced"),
    "a dangling link": ("dangling", [], "A link is not replaced"),
    "a folder": ("shoot", [], "is a folder"),
    "the current folder": (".", [], "never replaced"),
    "nothing": ("", [], "never replaced"),
    "the folder above": ("..", [], "never replaced"),
    "the current folder from inside": ("shoot/..", [], "never replaced"),
    "the root": ("/", [], "never replaced"),
    "a pipe": ("pipe", [], "is a pipe"),
    "a device": ("/dev/null", [], "is a device"),
    "the standard output": ("/dev/stdout", [], "link"),
    "a photograph": ("photo.jpg", [], "not a table"),
    "a text of the user's": ("thesis.txt", [], "not a table"),
    "a protected file": ("protected.csv", [], "write-protected"),
    "a folder that is missing": ("missing/x.csv", [], "there is no folder missing"),
    "a folder that is a file": ("thesis.txt/x.csv", [], "Not a directory"),
    "a name that is too long": ("x" * 300, [], "too long"),
    "an unfinished folder": ("unfinished/x.csv", [], "has not finished"),
}


@pytest.mark.parametrize("arrangement", FILES)
def test_a_file_is_refused_before_any_work(home: Path, arrangement: str) -> None:
    (home / "unfinished").mkdir()
    (home / "unfinished" / COMMAND).write_text("render")
    before = snapshot(home)
    path, inputs, said = FILES[arrangement]
    refuse(said, [table(path)], *inputs)
    assert snapshot(home) == before


FOLDERS = {
    "no folder of labcal's": ("photos", [], "has no mark"),
    "an input": ("shoot", ["shoot"], "an input of this command"),
    "the folder of an input": ("shoot", ["shoot/images/a.png"], "holds an input"),
    "the folder of an input, by a link": ("shoot", ["link/images/a.png"], "holds an input"),
    "where an input would be kept": ("x", ["x.labcal-old/images"], "holds an input"),
    "where an input is in the way": ("y", ["y.unfinished/images"], "holds an input"),
    "a link to a folder of labcal's": ("link", [], "A link is not replaced"),
    "a link with a slash": ("link/", [], "A link is not replaced"),
    "a dangling link": ("dangling", [], "A link is not replaced"),
    "the current folder": (".", [], "never replaced"),
    "the folder above": ("..", [], "never replaced"),
    "the current folder from inside": ("shoot/..", [], "never replaced"),
    "a folder from inside": ("shoot/images/..", [], "never replaced"),
    "the current folder by its name": ("../here", [], "the current folder"),
    "a folder above by its name": ("../../{above}", [], "the current folder"),
    "the root": ("/", [], "never replaced"),
    "the home folder": ("{home}", [], "your home folder"),
    "above the home folder": ("{above_home}", [], "your home folder"),
    "a file": ("table.csv", [], "is a file"),
    "a pipe": ("pipe", [], "is a pipe"),
    "a device": ("/dev/null", [], "is a device"),
    "in a file": ("thesis.txt/x", [], "Not a directory"),
    "deep in a file": ("thesis.txt/x/y", [], "Not a directory"),
    "a name that is too long when unfinished": ("x" * 250, [], "too long"),
    "an unfinished folder": ("unfinished/x", [], "has not finished"),
    "an unmarked unfinished folder": ("z", [], "no unfinished output"),
}


@pytest.mark.parametrize("arrangement", FOLDERS)
def test_a_folder_is_refused_before_any_work(
    home: Path, arrangement: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "people" / "me"))
    (tmp_path / "people" / "me").mkdir(parents=True)
    (home / "unfinished").mkdir()
    (home / "unfinished" / COMMAND).write_text("render")
    made(home / "x")
    made(home / "x.labcal-old")
    made(home / "y.unfinished")
    (home / "z.unfinished").mkdir()
    (home / "z.unfinished" / "notes.txt").write_text("mine")
    before = snapshot(tmp_path)
    path, inputs, said = FOLDERS[arrangement]
    path = path.format(above=tmp_path.name, home=tmp_path / "people" / "me", above_home=tmp_path / "people")
    refuse(said, [folder(path)], *inputs)
    assert snapshot(tmp_path) == before


@pytest.mark.parametrize(
    "outputs",
    [
        [table("x.json"), table("x.json")],
        [table("x.json"), table("./shoot/../x.json")],
        [table("x.json"), table("X.json")],
        [table("caf\u00e9.json"), table("cafe\u0301.json")],
        [table("link/x.json"), table("shoot/x.json")],
        [table("new/x.json"), folder("new")],
        [table("shoot/x.json"), folder("shoot")],
        [table("new"), folder("new/overlay")],
        [table("new.unfinished"), folder("new")],
        [table("new.labcal-old/x.csv"), folder("new")],
        [folder("new"), folder("new/inside")],
    ],
    ids=lambda outputs: " ".join(str(output.path) for output in outputs),
)
@pytest.mark.usefixtures("home")
def test_outputs_that_are_the_same_or_inside_each_other(outputs: list[FileOutput | FolderOutput]) -> None:
    refuse("outputs of the same command", outputs)


@pytest.mark.usefixtures("home")
def test_what_may_be_written_is_let_pass() -> None:
    for force in (False, True):
        claim_outputs([table("new.csv"), folder("new"), folder("some/where/new")], ["shoot"], force=force)
        claim_outputs([table("shoot/table.csv"), folder("shoot/overlay")], ["shoot"], force=force)
    claim_outputs([table("table.csv"), table("empty.csv"), folder("shoot")], ["other", "photos"], force=True)
    # Names of scenes and targets are no paths, and an input that is missing is told by who reads it.
    claim_outputs([table("table.csv"), folder("shoot")], ["rings-10x8", "missing.csv"], force=True)


@pytest.mark.usefixtures("home")
def test_what_exists_stays_without_force() -> None:
    for output in (table("table.csv"), table("empty.csv"), folder("shoot"), folder("photos"), folder("link")):
        with pytest.raises(OutputError, match="exists already"):
            claim_outputs([output], (), force=False)


def test_a_socket_and_a_folder_nobody_may_write_in(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        one.bind("socket")
        refuse("is a socket", [table("socket")])
        refuse("is a socket", [folder("socket")])
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path) != home)  # noqa: ARG005 - its form
    refuse("Permission denied", [folder("new")])
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path) != Path())  # noqa: ARG005 - its form
    refuse("Permission denied", [table("new.csv")])


def test_mounts_are_never_replaced(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os.path, "ismount", lambda path: Path(path).name == "shoot")
    refuse("mounted", [folder("shoot")])
    monkeypatch.setattr(os.path, "ismount", lambda path: Path(path).name == "images")
    refuse("images/", [folder("shoot")])
    monkeypatch.setattr(os.path, "ismount", lambda path: Path(path).name == "table.csv")
    refuse("mounted", [table("table.csv")])
    assert (home / "shoot" / "a").exists()


def test_folders_of_the_same_disk_that_are_mounted_are_told_by_linux() -> None:
    line = r"36 35 98:0 /mnt1 /a\040blank\134 rw,noatime master:1 - ext3 /dev/root rw"
    assert mounts.mounted_at(line) == "/a blank\\"
    assert mounts.is_mount(Path("/"))
    assert not mounts.is_mount(Path("/nowhere"))


def test_a_file_that_cannot_be_read_is_not_replaced(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = Path.open

    def refused(path: Path, *words: str, **options: str) -> object:
        if path.name == "table.csv":
            raise PermissionError(13, "Permission denied")
        return real(path, *words, **options)

    monkeypatch.setattr(Path, "open", refused)
    refuse("cannot be read", [table("table.csv")])
    assert (home / "table.csv").exists()


def test_kinds_are_told_by_the_content() -> None:
    assert TABLE.recognises(b"view,camera")
    assert not TABLE.recognises(b"camera,view")
    assert recognised_by("any", lambda content: b"x" in content).recognises(b"..x")
    assert overwriting.UNFINISHED == ".unfinished"  # a user finds it in the documents
