"""The scene beside the truth of a rendered shoot: it tells of lamps and cameras what no photograph does."""

from pathlib import Path

from labcal.errors import LabcalError
from labcal.scene.catalogue import load_scene
from labcal.scene.model import Scene
from labcal.shoot.truth import FOLDER

_NAME = "scene.yaml"


def rendered_scene(folder: Path) -> Scene | None:
    """Return the scene of a rendered shoot; None where there is none that can be read.

    Parameters
    ----------
    folder : Path
        Of a shoot.
    """
    path = folder / FOLDER / _NAME
    if not path.is_file():
        return None
    try:
        return load_scene(path)
    except LabcalError:
        return None
