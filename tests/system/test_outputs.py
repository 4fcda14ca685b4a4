"""Every command that writes, over what may stand where it is told to: only labcal's own is replaced."""

import os
import shutil
import stat
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from output_places import ARRANGEMENTS, a_text, linked, made, piped

from labcal import examples
from labcal.report.bench import at_most
from labcal.run.json_text import to_json
from labcal.run.made import MADE, provenance_text
from labcal.run.outputs import write_file
from labcal.shoot.dataset import Shoot, open_shoot
from labcal.shoot.pictures import write_single_picture

Run = Callable[..., Any]


@dataclass(frozen=True)
class Verb:
    """A command that writes, without what it is to write."""

    words: tuple[object, ...]
    inputs: tuple[str, ...] = ()
    """Paths in the laboratory that it reads."""
    ending: str = ""
    """Of the file that it writes; none where it makes a folder."""
    option: str = "-o"
    """What comes before the output; nothing where it is the last word."""

    def line(self, output: Path | str) -> tuple[object, ...]:
        """Return the whole command, with --force."""
        return (*self.words, *((self.option,) if self.option else ()), output, "--force")


HELD = ("calibrate", "held.csv", "--target", "paper-13x10", "--lens", "brown-k1k2")
VERBS = {
    "render": Verb(("render", "scene.yaml", "--workers", 1), ("scene.yaml",)),
    "scene gallery": Verb(("scene", "gallery")),
    "detect": Verb(("detect", "shoot", "--workers", 1), ("shoot/images/train_left.jpg",), ".csv"),
    "detect photographs": Verb(
        ("detect", "photos", "--target", "paper-13x10", "--cameras", "_left=left", "--workers", 1),
        ("photos/train_left.jpg",),
        ".csv",
    ),
    "detect --overlay": Verb(
        ("detect", "shoot", "--workers", 1, "-o", "shoot/new.csv"), ("shoot/shoot.json",), "", "--overlay"
    ),
    "inspect": Verb(("inspect", "shoot", "--workers", 1), ("shoot/images/train_left.jpg",), ".jpg"),
    "calibrate": Verb(HELD, ("held.csv",), ".json"),
    "calibrate --overlay": Verb(
        (*HELD, "--free-dots", "-o", "shoot/new.json"), ("held.csv",), ".png", "--overlay"
    ),
    "calibrate --start": Verb((*HELD[:4], "--start", "rig.json"), ("rig.json",), ".json"),
    "fit": Verb(
        ("fit", "shoot", "--method", "affine", "--detections", "dots.csv", "--no-rehearsal"),
        ("dots.csv",),
        ".model",
    ),
    "reconstruct": Verb(("reconstruct", "model", "dots.csv"), ("dots.csv",), ".csv"),
    "reconstruct by a rig": Verb(("reconstruct", "rig.json", "held.csv"), ("rig.json",), ".csv"),
    "measure": Verb(("measure", "rig.json", "pixels.csv"), ("pixels.csv",), ".csv"),
    "certify --plan": Verb(("certify", "--plan", "--volume-mm", "400,300,200"), (), ".csv"),
    "compare": Verb(("compare", "rig.json", "rig.json", "--pictures", "same"), ("rig.json",), ".html"),
    "convert": Verb(("convert", "rig.json", "--to", "opencv"), ("rig.json",), ".yml", ""),
    "convert to a folder": Verb(("convert", "rig.json", "--to", "colmap"), ("rig.json",), "", ""),
    "convert detections": Verb(
        ("convert", "held.csv", "--target", "square.yaml"), ("square.yaml",), ".vnl", ""
    ),
    "undistort": Verb(("undistort", "rig.json", "held"), ("rig.json", "held/shoot.json")),
    "target export": Verb(("target", "export", "square.yaml"), ("square.yaml",), ".svg"),
    "capture": Verb(("capture", "folder:held"), ("held/shoot.json",)),
    "rehearse": Verb(("rehearse", "plan.yaml"), ("plan.yaml",)),
    "twin": Verb(("twin", "held", "rig.json", "--workers", 1, "--views", 1), ("held/shoot.json",)),
    "reproduce": Verb(("reproduce", "13", "--quick", "--workers", 1)),
    "bench render": Verb(("bench", "render", "--quick")),
    "bench detect": Verb(("bench", "detect", "--only", "real", "--quick")),
    "bench solve": Verb(("bench", "solve", "--only", "real", "--quick")),
}


@pytest.fixture(scope="module")
def originals(labcal: Run, stage: Path, handheld: Path, stage_dots: Path, handheld_dots: Path,
              tmp_path_factory: pytest.TempPathFactory) -> Path:  # fmt: skip
    """A folder with all that the commands read."""
    home = tmp_path_factory.mktemp("originals") / "lab"
    home.mkdir()
    shutil.copytree(stage, home / "shoot")
    shutil.copytree(handheld, home / "held")
    shutil.copytree(stage / "images", home / "photos")
    for name in ("train_right", "test-shifted_left", "test-shifted_right"):
        (home / "photos" / f"{name}.jpg").unlink()
    shutil.copy(stage_dots, home / "dots.csv")
    shutil.copy(handheld_dots, home / "held.csv")
    (home / "plan.yaml").write_text(to_json(examples.rig_plan().model_dump(mode="json", exclude_none=True)))
    target = labcal("target", "show", "rings-14x10").document
    (home / "square.yaml").write_text(to_json(target))
    rig = ("calibrate", handheld_dots, "--target", "paper-13x10", "--lens", "brown-k1k2")
    assert labcal(*rig, "-o", home / "rig.json").status in {0, 1}
    words = ("--method", "affine", "--detections", stage_dots, "-o", home / "model")
    assert labcal("fit", stage, *words).status == 0
    small = [
        f"cameras.{name}.{key}"
        for name in ("left", "right")
        for key in ("size=[64, 48]", "focal_px=70", "principal_px=null")
    ]
    sets = [word for one in (*small, "spp=1") for word in ("--set", one)]
    (home / "scene.yaml").write_text(to_json(labcal("scene", "show", "webcam-plane", *sets).document))
    pixels = "".join(f"v,{camera},a,100,90,0.01,0,0.01\n" for camera in ("left", "right"))
    (home / "pixels.csv").write_text(f"view,camera,point,x_px,y_px,var_xx,var_xy,var_yy\n{pixels}")
    (home / "thesis.txt").write_text("years of work")
    (home / "mine").mkdir()
    (home / "mine" / "thesis.txt").write_text("years of work")
    return home


@pytest.fixture
def lab(originals: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The same, to be damaged; the current folder."""
    home = tmp_path / "above" / "lab"
    shutil.copytree(originals, home)
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)  # noqa: ARG005 -- no test here needs the disk
    (tmp_path / "above" / "thesis.txt").write_text("years of work")
    monkeypatch.chdir(home)
    return home


def snapshot(folder: Path) -> dict[str, tuple[int, bytes | str]]:
    """Return everything below a folder: kind and rights, and what is in it."""
    found: dict[str, tuple[int, bytes | str]] = {}
    for root, folders, files in os.walk(folder):
        for path in (Path(root, name) for name in (*folders, *files)):
            mode = path.lstat().st_mode
            link = os.readlink(path) if stat.S_ISLNK(mode) else ""  # noqa: PTH115 -- the same text
            name = path.relative_to(folder).as_posix()
            found[name] = (mode, path.read_bytes() if stat.S_ISREG(mode) else link)
    return found


QUICK = frozenset(
    {
        "a folder of the user's",
        "a file beside labcal's",
        "a hidden file beside labcal's",
        "another shoot inside",
        "a manifest edited by hand",
        "the current folder",
        "the folder above",
        "a folder from inside",
        "a link to a folder of labcal's",
        "a dangling link",
        "a text",
        "one of its format",
        "a pipe",
        "an unmarked unfinished folder",
    }
)
"""Those that are always tried; the rest is slow together."""
OF_FOLDERS = frozenset({"an unmarked unfinished folder", "another's unfinished folder with something in it"})
"""Of no concern to commands that write a file."""


_KINDS = {"OutputError", "UnknownNameError", "InputError"}
"""The last two where the ending of a name tells the format, and that of a folder tells none."""


def refused(labcal: Run, name: str, output: Path | str, lab: Path) -> None:
    """Assert that a command is refused, and that nothing was lost, altered or left behind."""
    before = snapshot(lab.parent)
    told = labcal(*VERBS[name].line(output))
    assert told.status == 2, (name, output, told)
    assert told.document["error"]["kind"] in _KINDS, (name, output, told)
    assert snapshot(lab.parent) == before, (name, output)


def slow_unless(quick: Collection[str], names: Collection[str]) -> list[object]:
    return [name if name in quick else pytest.param(name, marks=pytest.mark.slow) for name in names]


@pytest.mark.parametrize("arrangement", slow_unless(QUICK, ARRANGEMENTS))
def test_nothing_is_lost_that_labcal_did_not_make(labcal: Run, lab: Path, arrangement: str) -> None:
    outputs = {
        ending: ARRANGEMENTS[arrangement](lab / f"out{ending}")
        for ending in {verb.ending for verb in VERBS.values()}
    }
    for name, verb in VERBS.items():
        if not (verb.ending and arrangement in OF_FOLDERS):
            refused(labcal, name, outputs[verb.ending], lab)


@pytest.mark.parametrize("name", [name for name, verb in VERBS.items() if verb.inputs])
def test_no_input_is_lost(labcal: Run, lab: Path, name: str) -> None:
    verb = VERBS[name]
    for given in map(Path, verb.inputs):
        hard, link = Path(f"hard{verb.ending}"), Path(f"link{verb.ending}")
        os.link(given, hard)
        link.symlink_to(given)
        for output in (given, Path("..", "lab", given), lab / given, hard, link, given.parent, given / "x"):
            refused(labcal, name, output, lab)
        hard.unlink()
        link.unlink()
        if len(given.parts) > 1:
            refused(labcal, name, given.parts[0], lab)


def cheap(monkeypatch: pytest.MonkeyPatch, lab: Path) -> None:
    """Let the commands whose work takes long do less of it."""
    from labcal.bench import gallery  # noqa: PLC0415 - slow
    from labcal.bench.render import bench as bench_render  # noqa: PLC0415 - slow

    def shot(*words: object) -> Shoot:  # noqa: ARG001 - what a scene is rendered from
        return open_shoot(lab / "shoot")

    monkeypatch.setattr(gallery, "render_shoot", shot)
    for group in ("ray", "opencv", "sensor", "dot", "cost", "reproducibility"):
        monkeypatch.setattr(bench_render, f"{group}_checks", lambda *words: [])  # noqa: ARG005
    monkeypatch.setattr(bench_render, "shoot_check", lambda *words: at_most("seconds", 1.0, 2.0))  # noqa: ARG005
    monkeypatch.setattr(bench_render, "_even_light", lambda seed: None)  # noqa: ARG005


LONG = {
    "render",
    "detect --overlay",
    "calibrate",
    "calibrate --overlay",
    "calibrate --start",
    "rehearse",
    "twin",
    "reproduce",
}


@pytest.mark.parametrize("name", slow_unless(VERBS.keys() - LONG, VERBS))
def test_what_labcal_made_is_replaced(
    labcal: Run, lab: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    cheap(monkeypatch, lab)
    monkeypatch.delenv("LABCAL_REAL_DATA", raising=False)
    verb = VERBS[name]
    output, before = lab / f"out{verb.ending}", snapshot(lab.parent)
    assert labcal(*verb.line(output)).status in {0, 1}
    written = snapshot(lab.parent)
    assert {key: written[key] for key in before} == before
    inode = next(path for path in lab.glob("out*")).stat().st_ino
    again = labcal(*verb.line(output))
    assert again.status in {0, 1}, again
    replaced = snapshot(lab.parent)
    assert next(path for path in lab.glob("out*")).stat().st_ino != inode
    assert replaced.keys() == written.keys()  # nothing is left beside it
    assert {key: replaced[key] for key in before} == before
    told = labcal(*(word for word in verb.line(output) if word != "--force"))
    assert told.status == 2
    assert "exists already" in told.document["error"]["message"]
    assert snapshot(lab.parent) == replaced


def test_files_of_another_shoot_stay_whoever_wrote_them(labcal: Run, lab: Path) -> None:
    other = lab / "other"
    shutil.copytree(lab / "shoot", other)
    picture = other / "images" / "train_left.jpg"
    write_single_picture(lab / "own.jpg", np.zeros((48, 64), np.uint8))
    for _ in range(2):
        refused(labcal, "inspect", picture, lab)
        refused(labcal, "convert", other / "truth" / "truth.json", lab)
        shutil.copy("own.jpg", picture)
        refused(labcal, "inspect", picture, lab)
        (other / MADE).unlink(missing_ok=True)  # shoot.json tells, too
    assert labcal("undistort", "rig.json", "held", "-o", "flat").status == 0
    refused(labcal, "calibrate", lab / "flat" / "rig.json", lab)
    for output in (other / "sheet.jpg", lab / "flat" / "images" / "sheet.jpg"):
        for _ in range(2):  # what does not belong to a folder is written there, and again
            assert labcal(*VERBS["inspect"].line(output)).status == 0


def test_what_somebody_has_changed_stays(labcal: Run, lab: Path) -> None:
    for name in ("inspect", "convert", "convert detections", "target export"):
        output = lab / f"out{VERBS[name].ending}"
        assert labcal(*VERBS[name].line(output)).status in {0, 1}
        output.write_bytes(output.read_bytes() + b"\n")
        refused(labcal, name, output, lab)
    folder = made(lab / "out")
    write_file(folder / "run.json", "{}", force=True)
    mark = (folder / MADE).read_text().replace('"files": {', '"files": {\n  "run.json": null,')
    (folder / MADE).write_text(mark)
    for content in (b"{}", provenance_text({"seconds": 1.0}).replace(b"1.0", b"2.0")):
        (folder / "run.json").write_bytes(content)
        refused(labcal, "render", folder, lab)


@pytest.mark.slow
def test_a_report_replaces_its_own_page_and_no_other(labcal: Run, lab: Path) -> None:
    assert labcal("reproduce", "13", "--quick", "--workers", 1, "-o", "out").status == 0
    page = lab / "out" / "index.html"
    for _ in range(2):
        assert labcal("report", "out").status == 0
    assert labcal("reproduce", "13", "--quick", "--workers", 1, "-o", "out", "--force").status == 0
    page.write_text(page.read_text() + "<!-- my remarks -->")
    before = snapshot(lab.parent)
    assert labcal("report", "out").status == 2
    assert labcal("reproduce", "13", "--quick", "--workers", 1, "-o", "out", "--force").status == 2
    assert snapshot(lab.parent) == before
    assert labcal("report", "out", "--force").status == 0
    for lay in (a_text, piped, linked("../thesis.txt"), linked("nowhere"), lambda path: path.mkdir()):
        page.unlink()
        lay(page)
        before = snapshot(lab.parent)
        for force in ((), ("--force",)):
            assert labcal("report", "out", *force).status == 2
        assert snapshot(lab.parent) == before
