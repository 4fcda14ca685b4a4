"""What may stand in the place where a command is to write: labcal's own things, and other people's."""

import os
import shutil
import socket
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from labcal.run.begun import COMMAND
from labcal.run.made import MADE
from labcal.run.outputs import write_file
from labcal.run.unfinished import unfinished_folder


def made(folder: Path, command: str = "render") -> Path:
    """Make a folder as a command does."""
    with unfinished_folder(folder, command, force=False) as working:
        (working / "images").mkdir()
        write_file(working / "shoot.json", "{}", force=True)
        write_file(working / "images" / "a.jpg", "a picture", force=True)
    return folder


Arrange = Callable[[Path], Path | str]
"""Takes the path of an output, lays something there, and returns how the command line names it."""


def with_something(name: str) -> Arrange:
    """Return what makes a folder of labcal's with something else in it."""

    def arrange(output: Path) -> Path:
        path = made(output) / name
        if name.endswith("/"):
            path.mkdir()
        else:
            path.write_text("years of work")
        return output

    return arrange


def edited(output: Path) -> Path:
    (made(output) / "shoot.json").write_text('{"edited": "by hand"}')
    return output


def another_shoot_inside(output: Path) -> Path:
    shutil.copytree(output.parent / "shoot", made(output) / "images" / "other")
    return output


def a_link_inside(to: str) -> Arrange:
    def arrange(output: Path) -> Path:
        (made(output) / "link").symlink_to(to)
        return output

    return arrange


def linked(to: str) -> Arrange:
    def arrange(output: Path) -> Path:
        output.symlink_to(to)
        return output

    return arrange


def linked_to_labcals(output: Path) -> Path:
    made(output.with_name(f"real-{output.name}"))
    output.symlink_to(f"real-{output.name}")
    return output


def listening(output: Path) -> Path:
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(output.name)
    return output


def piped(output: Path) -> Path:
    os.mkfifo(output)
    return output


def protected_folder(output: Path) -> Path:
    made(output).chmod(0o555)
    return output


def protected_file(output: Path) -> Path:
    output.write_text("")
    output.chmod(0o444)
    return output


def unfinished(*, marked: bool) -> Arrange:
    """Return what leaves an unfinished folder with something of the user's in the way."""

    def arrange(output: Path) -> Path:
        working = output.with_name(f"{output.name}.unfinished")
        working.mkdir()
        if marked:
            (working / COMMAND).write_text("another")
        (working / "thesis.txt").write_text("years of work")
        return output

    return arrange


def in_an_unfinished_folder(output: Path) -> Path:
    unfinished(marked=True)(output)
    return output.with_name(f"{output.name}.unfinished") / output.name


def an_old_folder_in_the_way(output: Path) -> Path:
    old = output.with_name(f"{output.name}.labcal-old")
    old.mkdir()
    (old / "thesis.txt").write_text("years of work")
    return made(output)


def a_text(output: Path) -> Path:
    output.write_text("years of work")
    return output


def a_photograph(output: Path) -> Path:
    output.write_bytes(b"GIF89a" + bytes(100))
    return output


def one_of_its_format(output: Path) -> Path:
    """Lay a file of the user's there that begins as the one to be written, or holds what it holds."""
    if output.suffix == ".jpg":
        shutil.copy(output.parent / "photos" / "train_left.jpg", output)
    else:
        output.write_bytes(FOREIGN[output.suffix])
    return output


def one_of_its_format_in_another_shoot(output: Path) -> Path:
    """Lay the same among the pictures of a shoot that no mark tells of."""
    shutil.copytree(output.parent / "shoot", output.parent / "other", dirs_exist_ok=True)
    (output.parent / "other" / MADE).unlink(missing_ok=True)
    one_of_its_format(output).rename(output.parent / "other" / "images" / output.name)
    return output.parent / "other" / "images" / output.name


FOREIGN = {
    "": b"years of work",
    ".csv": b"view,camera,image,remark\n1,left,a.png,the third of May\n",
    ".png": cv2.imencode(".png", np.arange(64, dtype=np.uint8).reshape(8, 8))[1].tobytes(),
    ".json": b'{\n  "format": "labcal-rigging"\n}',
    ".model": b'\x60\0\0\0\0\0\0\0{"a": {"what": "learned from a labcal-model"}}',
    ".yml": b"%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 1\n   cols: 1\n   dt: d\n   data: [ 1. ]\n",
    ".vnl": b"# filename x y level\na.png 1 2 0\n",
    ".html": b"<!doctype html>\n<title>years of work</title>\n",
    ".svg": b'<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg"/>\n',
}


ARRANGEMENTS: dict[str, Arrange] = {
    "a folder of the user's": lambda output: output.parent / "mine",
    "a folder of photographs": lambda output: output.parent / "photos",
    "a file beside labcal's": with_something("thesis.txt"),
    "a hidden file beside labcal's": with_something(".thesis"),
    "a file among labcal's pictures": with_something("images/thesis.txt"),
    "a folder beside labcal's": with_something("mine/"),
    "another shoot inside": another_shoot_inside,
    "a link beside labcal's": a_link_inside("../mine"),
    "a dangling link beside labcal's": a_link_inside("nowhere"),
    "a manifest edited by hand": edited,
    "the current folder": lambda output: ".",  # noqa: ARG005 - all take it
    "the current folder by its path": lambda output: output.parent,
    "the current folder from inside": lambda output: "mine/..",  # noqa: ARG005 - all take it
    "the folder above": lambda output: "..",  # noqa: ARG005 - all take it
    "the folder above by its path": lambda output: output.parent.parent,
    "a folder from inside": lambda output: made(output) / "images" / "..",
    "a link to a folder of labcal's": linked_to_labcals,
    "a link to a folder of the user's": linked("mine"),
    "a link to a file": linked("thesis.txt"),
    "a dangling link": linked("nowhere"),
    "a link to itself": lambda output: linked(output.name)(output),
    "a text": a_text,
    "a photograph of another kind": a_photograph,
    "one of its format": one_of_its_format,
    "one of its format in another shoot": one_of_its_format_in_another_shoot,
    "in a text": lambda output: a_text(output) / output.name,
    "a pipe": piped,
    "a socket": listening,
    "a protected folder": protected_folder,
    "a protected file": protected_file,
    "an unmarked unfinished folder": unfinished(marked=False),
    "another's unfinished folder with something in it": unfinished(marked=True),
    "in an unfinished folder": in_an_unfinished_folder,
    "an old folder in the way": an_old_folder_in_the_way,
    "a name too long": lambda output: output.with_name("x" * 260 + output.name),
}
