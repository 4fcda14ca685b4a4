"""Which command reads which file, as little of it as does so."""

from dataclasses import dataclass

from labcal.cameras.interop.exchange import Home
from labcal.cameras.interop.registry import FORMATS
from labcal.estimators.registry import method_names


@dataclass(frozen=True)
class Job:
    """A file that is mutated, and the command that reads it."""

    name: str
    file: str
    """Relative to the seeds; what is mutated."""
    kind: str
    """Of :func:`fuzz.kinds.of_kind`."""
    argv: tuple[str, ...]
    """``{file}`` is the mutant, ``{seeds}`` the folder of the seeds with the mutant in its place."""
    output: str = ""
    """What it writes, in the working folder, of the kind that :mod:`fuzz.judge` knows by its ending."""
    weight: int = 2
    option: bool = False
    """Whether the mutant is the value of an option in `argv` and no file: ``{text}``."""


def _formats() -> list[Job]:
    jobs = []
    for name, made in FORMATS.items():
        if made.home is Home.FOLDER:
            jobs += [
                Job(f"{name} {file}{made.suffixes[0]}", f"formats/{name}/{file}{made.suffixes[0]}",
                    "bytes" if made.binary else "text",
                    ("convert", f"{{seeds}}/formats/{name}", "out.json", "--to", "labcal"), "out.json")
                for file in ("cameras", "images", "rigs", "frames")
            ]  # fmt: skip
            continue
        pair = name in {"mrcal", "ros"}
        ending = made.suffixes[0]
        file = f"formats/{name}/rig{'-left' if pair else ''}{ending}"
        inputs = ("{file}", f"{{seeds}}/formats/{name}/rig-right{ending}") if pair else ("{file}",)
        kind = "json" if name == "labcal" else "yaml" if name in {"kalibr", "ros"} else "text"
        kind = "bytes" if made.binary else kind
        size = ("--size", "640x480") if name == "matchid" else ()
        words = ("convert", *inputs, "out.json", "--to", "labcal", *size)
        jobs.append(Job(name, file, kind, words, "out.json"))
        if kind == "yaml":
            jobs.append(Job(f"{name} text", file, "text", jobs[-1].argv, "out.json", 1))
    return jobs


_RECONSTRUCT = ("reconstruct", "{file}", "{seeds}/detections.csv", "-o", "out.csv")
_RIG = ("reconstruct", "{seeds}/rig.json", "{file}", "-o", "out.csv")
_MEASURE = ("measure", "{seeds}/rig.json", "{seeds}/pixels.csv", "-o", "out.csv")
_TARGET = "{seeds}/target.yaml"

JOBS: tuple[Job, ...] = (
    *_formats(),
    Job("opencv xml", "rig.xml", "text", ("convert", "{file}", "out.json", "--to", "labcal"), "out.json"),
    Job("vic-3d", "vic3d.xml", "text", ("convert", "{file}", "out.json", "--to", "labcal"), "out.json"),
    Job("rig to mrcal", "rig.json", "json", ("convert", "{file}", "out.cameramodel"), weight=1),
    Job("rig", "rig.json", "json", _RECONSTRUCT, "out.csv", 4),
    Job("windowed rig", "windowed.json", "json", _RECONSTRUCT, "out.csv"),
    Job("rig to undistort", "rig.json", "json",
        ("undistort", "{file}", "{seeds}/frame_left.png", "--cameras", "_left=left", "-o", "out"), weight=1),
    Job("target", "target.yaml", "yaml", ("target", "show", "{file}"), "target", 4),
    Job("target to export", "target.yaml", "yaml", ("target", "export", "{file}", "-o", "out.svg"), weight=1),
    Job("charuco", "charuco.yaml", "yaml", ("target", "show", "{file}"), "target"),
    Job("boards", "boards.yaml", "yaml", ("target", "show", "{file}"), "target"),
    Job("boards to export", "boards.yaml", "yaml", ("target", "export", "{file}", "-o", "out.svg"), weight=1),
    Job("asymmetric", "asymmetric.yaml", "yaml", ("target", "show", "{file}"), "target"),
    Job("target of dots", "target.yaml", "yaml",
        ("reconstruct", "{seeds}/rig.json", "{seeds}/detections.csv", "--target", "{file}", "-o", "out.csv"),
        "out.csv", 1),
    Job("scene", "scene.yaml", "yaml", ("scene", "show", "{file}"), weight=4),
    Job("scene to check", "scene.yaml", "yaml", ("scene", "check", "{file}"), weight=3),
    Job("lens", "lens.yaml", "yaml",
        ("scene", "show", "{seeds}/scene.yaml", "--set", "cameras.left.lens=prescription", "--set",
         "cameras.left.dist=[]", "--set", "cameras.left.prescription={file}")),
    Job("photometry", "photometry.yaml", "yaml",
        ("scene", "show", "{seeds}/scene.yaml", "--set", "photometry={text}"), option=True),
    *(Job(f"placement {kind}", f"{kind}.yaml", "yaml",
          ("scene", "check", "{seeds}/scene.yaml", "--set", "placement={text}"), option=True, weight=1)
      for kind in ("handheld", "volume", "planes")),
    Job("value", "tone.csv", "text",
        ("scene", "show", "{seeds}/scene.yaml", "--set", "cameras.left.focal_px={text}"), option=True),
    Job("key", "tone.csv", "text",
        ("scene", "show", "{seeds}/scene.yaml", "--set", "{text}=1"), option=True),
    Job("manifest", "shoot/shoot.json", "json",
        ("evaluate", "{seeds}/points.csv", "{seeds}/shoot"), weight=4),
    Job("manifest to detect", "shoot/shoot.json", "json",
        ("detect", "{seeds}/shoot", "--workers", "1", "-o", "out.csv"), weight=1),
    Job("truth", "shoot/truth/truth.json", "json", ("evaluate", "{seeds}/points.csv", "{seeds}/shoot",
        "--detections", "{seeds}/detections.csv"), weight=3),
    Job("true dots", "shoot/truth/dots.csv", "text", ("evaluate", "{seeds}/points.csv", "{seeds}/shoot",
        "--detections", "{seeds}/detections.csv"), weight=3),
    Job("points", "points.csv", "text", ("evaluate", "{file}", "{seeds}/shoot"), weight=3),
    Job("points and lengths", "points.csv", "text", ("evaluate", "{file}", "--target", _TARGET)),
    Job("places", "rig-dots.json", "json",
        ("evaluate", "{seeds}/points.csv", "--dots", "{file}"), weight=3),
    Job("detections", "detections.csv", "text", _RIG, "out.csv", 4),
    Job("detections of a target", "detections.csv", "text", (*_RIG, "--target", _TARGET), "out.csv"),
    Job("detections to calibrate", "detections.csv", "text",
        ("calibrate", "{file}", "--target", _TARGET, "--lens", "brown-k1k2", "-o", "out.json"),
        "out.json", 1),
    Job("start", "rig.json", "json",
        ("calibrate", "{seeds}/detections.csv", "--target", _TARGET, "--start", "{file}", "--fix-intrinsics",
         "-o", "out.json"), "out.json", 1),
    Job("detections to corners", "detections.csv", "text",
        ("convert", "{file}", "out.vnl", "--target", _TARGET)),
    Job("corners", "corners.vnl", "text",
        ("convert", "{file}", "out.csv", "--target", _TARGET, "--cameras", "_left=left,_right=right",
         "--size", "640x480"), weight=3),
    Job("size", "tone.csv", "text",
        ("convert", "{seeds}/corners.vnl", "out.csv", "--target", _TARGET, "--size", "{text}"), option=True,
        weight=1),
    Job("pixels", "pixels.csv", "text", (*_MEASURE[:2], "{file}", *_MEASURE[3:]), "out.csv", 4),
    Job("known points", "known.csv", "text",
        (*_MEASURE, "--frame", "similarity:{file}"), "out.csv"),
    Job("rig to measure", "rig.json", "json",
        ("measure", "{file}", *_MEASURE[2:], "--frame", "points:0-0,5-0,0-4"), "out.csv"),
    Job("lengths", "lengths.csv", "text",
        ("certify", "{seeds}/rig.json", "{seeds}/pixels.csv", "--lengths", "{file}"),
        weight=3),
    Job("rig to compare", "rig.json", "json",
        ("compare", "{seeds}/rig.json", "{file}", "--distances-mm", "600"), weight=3),
    Job("deeplabcut", "dlc.csv", "text", ("convert", "{file}", "named.csv", "--from", "dlc")),
    Job("tracks", "tracks.txt", "text", ("convert", "{file}", "named.csv", "--from", "colmap-tracks")),
    Job("columns", "vic.csv", "text",
        ("convert", "{file}", "named.csv", "--from", "columns", "--columns",
         "sigma=sigma,left=x+u:y+v,right=x+q:y+r")),
    Job("tone curve", "tone.csv", "text",
        ("detect", "{seeds}/p.png", "--target", _TARGET, "--tone-curve", "{file}", "--workers", "1",
         "-o", "out.csv")),
    *(Job(method, f"{method}.safetensors", "model", _RECONSTRUCT, "out.csv") for method in method_names()),
    *(Job(f"picture {file}", file, "bytes",
          ("detect", "{file}", "--target", _TARGET, "--workers", "1", "-o", "out.csv"))
      for file in ("p.png", "p.jpg", "p.bmp", "p.tif", "strips.tif", "p.exr", "p.pgm", "p.webp")),
    Job("picture to inspect", "p.png", "bytes",
        ("inspect", "{file}", "--target", _TARGET, "--workers", "1", "-o", "out.png"), weight=1),
    Job("results", "results/results.json", "json", ("report", "{seeds}/results"), weight=3),
    Job("mark", "tone.csv", "bytes", ("convert", "{seeds}/rig.json", "marked", "--to", "colmap"), weight=1),
)  # fmt: skip
"""All of them; `mark` is a command's mark in an unfinished folder."""
