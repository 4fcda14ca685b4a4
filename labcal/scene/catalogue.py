"""Scenes by name or from a YAML file, with single values set on the command line."""

from labcal.errors import InputError
from labcal.paths import AnyPath, as_text
from labcal.run.descriptions import description_content, description_names, validate_description
from labcal.scene.model import Scene
from labcal.scene.overrides import apply_overrides
from labcal.scene.photometry import Photometry
from labcal.scene.sensor_presets import expanded
from labcal.targets.catalogue import described_target

FOLDER = "scenes"


def scene_names() -> list[str]:
    """Return the names of the scenes that labcal ships, sorted."""
    return description_names(FOLDER)


def load_scene(name: AnyPath, overrides: tuple[str, ...] = ()) -> Scene:
    """Return the scene of that name.

    Parameters
    ----------
    name : str or os.PathLike
        The name of a shipped scene, or the path of a YAML file.
    overrides : tuple of str
        ``key=value`` each; the key is dotted (``cameras.left.focal_px``), the value is YAML.

    Raises
    ------
    UnknownNameError
        No scene, target or key has that name; the nearest name is offered.
    InputError
        The description cannot be read, or a value in it is not allowed.
    """
    name = as_text(name)
    scene = validate_description(Scene, "scene", name, description_content("scene", FOLDER, name))
    if not overrides:
        return scene
    _refuse_target_twice(overrides)
    # The dump holds every key, so that one left at its default can be set and a wrong one is found.
    content = apply_overrides(scene.model_dump(mode="json"), overrides, _WRITTEN_OUT)
    return validate_description(Scene, "scene", name, content)


def _whole_target(value: object) -> object:
    """Return the keys of a target given by its name, or of boards side by side given by a list of names."""
    named = isinstance(value, str) or (isinstance(value, list) and bool(value))
    return described_target(value).model_dump(mode="json") if named else value


def _refuse_target_twice(overrides: tuple[str, ...]) -> None:
    """Raise where a target is set again, which would be another one in its place and none beside it."""
    given = [text.partition("=")[2] for text in overrides if text.startswith("target=")]
    if len(given) > 1:
        raise InputError(
            f"The scene's target is set {len(given)} times. For boards side by side in the pictures give a "
            f"list: 'target=[{', '.join(given)}]'; else set it once."
        )


def _whole_photometry(value: object) -> object:
    """Return all keys of a sensor given by a preset, or by some of its keys."""
    given = expanded(value)
    return {**Photometry().model_dump(mode="json"), **given} if isinstance(given, dict) else given


_WRITTEN_OUT = {"target": _whole_target, "photometry": _whole_photometry}
