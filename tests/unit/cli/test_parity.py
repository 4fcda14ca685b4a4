"""Each option of a verb has an argument in Python with the same default, and each argument has an option."""

import argparse
import inspect
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from typing import Any

import pytest

import labcal
from labcal import pipeline
from labcal.cli import build_parser
from labcal.report.inspection import Inspection
from labcal.targets.places import DotPlaces

SETTINGS: dict[str, tuple[type, ...]] = {
    "render": (pipeline.RenderSettings,),
    "capture": (pipeline.CaptureSettings, pipeline.SourceSettings, pipeline.GuideSettings),
    "inspect": (),
    "detect": (),
    "calibrate": (pipeline.HandheldSettings,),
    "fit": (pipeline.FitSettings,),
    "reconstruct": (pipeline.MeasureSettings,),
    "measure": (pipeline.MeasureSettings,),
    "evaluate": (),
    "check": (pipeline.CheckSettings,),
    "diagnose": (),
    "certify": (pipeline.CertifySettings,),
    "compare": (pipeline.CompareSettings,),
    "convert": (pipeline.ConvertSettings,),
    "undistort": (pipeline.UndistortSettings,),
    "rehearse": (pipeline.RehearseSettings,),
    "twin": (pipeline.TwinSettings,),
    "reproduce": (pipeline.ReproduceSettings,),
    "bench": (pipeline.BenchSettings,),
}
"""Verbs whose work is a function of `pipeline`, and the settings of that function."""

Place = tuple[Callable[..., Any], str]
CAMERAS: Place = (pipeline.open_pictures, "cameras")
RAW: Place = (pipeline.open_pictures, "raw")
CHANGES: Place = (pipeline.detect_settings, "words")
WORKERS: Place = (pipeline.detect, "workers")
TARGET: Place = (labcal.Shoot.showing, "target")
PLY: dict[str, Place | str] = {"ply": (labcal.write_ply, "path"), "encoding": (labcal.write_ply, "encoding")}
ELSEWHERE: dict[str, dict[str, Place | str]] = {
    "render": {"output": "folder"},
    "capture": {
        "output": "folder",
        "on_enter": "ask",
        "guided": "guide",
        "page": (pipeline.capture_live, "live"),
        "page_port": (pipeline.LiveSettings, "port"),
    },
    "inspect": {
        "cameras": CAMERAS,
        "raw": RAW,
        "changes": CHANGES,
        "output": "page",
        "force": (Inspection.save, "force"),
    },
    "detect": {
        "cameras": CAMERAS,
        "raw": RAW,
        "changes": CHANGES,
        "overlay": (pipeline.write_overlays, "folder"),
        "print_scale": (labcal.Shoot.with_print_scale, "print_scale"),
        "output": (labcal.Detections.save, "path"),
        "force": (labcal.Detections.save, "force"),
    },
    "calibrate": {
        "changes": CHANGES,
        "workers": WORKERS,
        "target": TARGET,
        "print_scale": (labcal.Shoot.with_print_scale, "print_scale"),
        "fix_intrinsics": "lenses",
        "free_dots": "dot_places",
        "keep_dots": "dot_places",
        "overlay": (labcal.Calibration.plot_displacements, "self"),
        "output": (labcal.Calibration.save, "path"),
        "force": (labcal.Calibration.save, "force"),
    },
    "fit": {
        "changes": CHANGES,
        "workers": WORKERS,
        "target": TARGET,
        "no_rehearsal": "rehearsal",
        "free_dots": "dot_places",
        "keep_dots": "dot_places",
        "output": (labcal.Model.save, "path"),
        "force": (labcal.Model.save, "force"),
    },
    "reconstruct": {
        "changes": CHANGES,
        "workers": WORKERS,
        "source": "detections",
        "method": (labcal.load_model, "method"),
        "output": (labcal.Points.save, "path"),
        "force": (labcal.Points.save, "force"),
        **PLY,
    },
    "measure": {
        "source": "pixels",
        "mark_diameter": (pipeline.MarkSearch, "mark_diameter"),
        "tone_curve": (pipeline.MarkSearch, "tone_curve"),
        "cameras": CAMERAS,
        "raw": RAW,
        "changes": CHANGES,
        "workers": (pipeline.find_marks, "workers"),
        "overlay": (pipeline.write_mark_overlays, "folder"),
        "pixels": (labcal.NamedPixels.save, "path"),
        "method": (labcal.load_model, "method"),
        "output": (labcal.NamedPoints.save, "path"),
        "displacements": (labcal.Displacements.save, "path"),
        "reference_view": (labcal.displacements, "reference_view"),
        "force": (labcal.NamedPoints.save, "force"),
        **PLY,
    },
    "evaluate": {
        "shoot": "source",
        "target": "source",
        "holdout": (pipeline.evaluate_held_out, "parts"),
        "lens": (pipeline.evaluate_held_out, "lens"),
        "free_dots": (pipeline.HandheldSettings, "dot_places"),
        "keep_dots": (pipeline.HandheldSettings, "dot_places"),
        "dots": (DotPlaces.load, "path"),
        "force": (pipeline.PageOutput, "force"),
    },
    "check": {
        "pictures": "source",
        "cameras": CAMERAS,
        "raw": RAW,
        "changes": CHANGES,
        "workers": WORKERS,
        "dots": (DotPlaces.load, "path"),
        "mend": (labcal.RigCheck.mended, "self"),
        "force": (pipeline.PageOutput, "force"),
    },
    "diagnose": {
        "pictures": "source",
        "cameras": CAMERAS,
        "raw": RAW,
        "force": (pipeline.PageOutput, "force"),
    },
    "certify": {
        "source": "points",
        "output": "page",
        "force": (pipeline.PageOutput, "force"),
        "plan": (labcal.LengthPlan.save, "path"),
        "longest_mm": (labcal.plan_lengths, "longest_mm"),
    },
    "compare": {"force": (pipeline.PageOutput, "force")},
    "convert": {"check": (pipeline.understand, "inputs")},
    "undistort": {"cameras": CAMERAS, "raw": RAW, "output": "folder"},
    "rehearse": {"output": "folder"},
    "twin": {"cameras": CAMERAS, "raw": RAW, "dots": (DotPlaces.load, "path"), "output": "folder"},
    "reproduce": {"output": "folder"},
    "bench": {"output": "folder", "only": "groups", "method": "methods"},
}
"""Options whose argument has another name, or is one of another function: that one, and its name there."""

PRESENTATION = {"help", "json", "quiet"}
ONLY_IN_PYTHON = {
    "progress": "the command line draws a bar where a person watches",
    "settings": "its fields are arguments of their own",
    "source_settings": "as above",
    "eccentricity_rounds": "0 for pixels that are images of centres, which the detector never measures",
}
OTHER_DEFAULTS = {
    "workers": "a script without a main guard cannot start processes; a command starts one a core",
    "method": "a command names its methods; a notebook begins with the one that is recommended",
    "lenses": "a word in Python, a switch on the command line",
    "dot_places": "a word in Python, two switches on the command line",
    "rehearsal": "the switch leaves it out",
}
"""Arguments whose default differs from that of the option, and why."""


def actions(verb: str) -> list[argparse.Action]:
    """Return the arguments and options of a verb that its work depends on."""
    (commands,) = build_parser(verb)._subparsers._group_actions  # type: ignore[union-attr]
    every = commands.choices[verb]._actions  # type: ignore[index]
    return [action for action in every if action.dest not in PRESENTATION]


def arguments(verb: str) -> dict[str, object]:
    """Return the arguments of a verb's function and of its settings, with their defaults."""
    found = {name: one.default for name, one in inspect.signature(getattr(pipeline, verb)).parameters.items()}
    for settings in SETTINGS[verb]:
        assert is_dataclass(settings)
        found |= {one.name: one.default for one in fields(settings)}
    assert MISSING not in found.values()
    return found


def place_of(verb: str, option: str) -> tuple[Mapping[str, object], str]:
    """Return the arguments among which an option has its own, and its name there."""
    place = ELSEWHERE[verb].get(option, option)
    if isinstance(place, str):
        return arguments(verb), place
    function, name = place
    parameters = inspect.signature(function).parameters.items()
    # Of a method of a class, the object itself is what a call begins with.
    return {known: one.default for known, one in parameters}, name


def plain(value: object) -> object:
    """Return a default in one form: nothing given is None, False, or empty."""
    return None if value in (None, False, (), [], inspect.Parameter.empty) else value


CASES = [(verb, action) for verb in SETTINGS for action in actions(verb)]


@pytest.mark.parametrize(("verb", "action"), CASES, ids=[f"{verb}-{one.dest}" for verb, one in CASES])
def test_an_option_has_an_argument_with_its_default(verb: str, action: argparse.Action) -> None:
    known, name = place_of(verb, action.dest)
    assert name in known, f"labcal {verb}: {action.dest} has no argument in Python"
    if name not in OTHER_DEFAULTS:
        assert plain(action.default) == plain(known[name]) or action.required


@pytest.mark.parametrize("verb", SETTINGS)
def test_an_argument_has_an_option(verb: str) -> None:
    reached = {place_of(verb, action.dest)[1] for action in actions(verb)}
    missing = arguments(verb).keys() - reached - ONLY_IN_PYTHON.keys()
    assert not missing, f"labcal {verb} has no option for {', '.join(sorted(missing))}"


def test_verbs_with_a_function_are_all_here() -> None:
    functions = {name for name in pipeline.__all__ if inspect.isfunction(getattr(pipeline, name))}
    from labcal.cli import VERBS  # noqa: PLC0415

    assert functions & VERBS.keys() == SETTINGS.keys() == ELSEWHERE.keys()


def test_an_option_without_an_argument_would_be_found() -> None:
    known, name = place_of("detect", "brand_new")
    assert name not in known
