"""Pictures from the rendered laboratory."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from labcal.arguments import settings_of, texts
from labcal.paths import AnyPath, as_path
from labcal.run.progress import Progress, progress_of
from labcal.shoot.dataset import Shoot

if TYPE_CHECKING:
    from labcal.render.shoot import RenderSettings


def render(
    scene: AnyPath,
    folder: AnyPath,
    settings: "RenderSettings | None" = None,
    overrides: Sequence[str] = (),
    progress: Progress | None = None,
) -> Shoot:
    """Render a scene into a new shoot: pictures, a manifest, and the truth in a folder apart.

    Parameters
    ----------
    scene : str or path
        The name of a scene that labcal ships, or the path of a YAML file.
    folder : path
        The folder to appear. What an interrupted run left is gone on with.
    settings : RenderSettings, optional
    overrides : sequence of str
        Values of the scene to change, as in ``"cameras.left.focal_px=800"``.
    progress : Progress, optional

    Returns
    -------
    Shoot
        The folder, opened.

    Raises
    ------
    UnknownNameError, InputError
        There is no such scene, or something in it is not allowed.
    OutputError
        The folder exists already, or may not be made.
    DeviceError
        The renderer does not work on this machine.

    Examples
    --------
    >>> from labcal import pipeline
    >>> quick = pipeline.RenderSettings(spp=16, views=2)
    >>> pipeline.render("webcam-plane", "shoot", quick, ["cameras.left.focal_px=800"])  # doctest: +SKIP
    Shoot(folder=shoot, target=paper-13x10, cameras=['left', 'right'], train=1, test=1)
    """
    from labcal.render.shoot import RenderSettings, render_shoot
    from labcal.scene.catalogue import load_scene

    how, receiver = settings_of(settings, RenderSettings), progress_of(progress)
    loaded = load_scene(scene, texts(overrides, "overrides"))
    return render_shoot(loaded, as_path(folder), how, receiver)
