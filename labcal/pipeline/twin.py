"""The digital twin of a shoot: rendered again with its calibrated rig, and compared with the photographs."""

import os
import shlex
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from labcal.arguments import settings_of
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.pipeline.detection import detect
from labcal.pipeline.pages import page_maker
from labcal.pipeline.print_places import dots_beside, given_places
from labcal.run.progress import Progress, progress_of
from labcal.targets.catalogue import AnyTarget
from labcal.targets.places import DotPlaces, is_places

if TYPE_CHECKING:
    from labcal.correspond.picture_set import AnyPictures, PictureSet
    from labcal.guide.twin.making import Photographs
    from labcal.guide.twin.settings import TwinSettings
    from labcal.guide.twin.twin import Twin
    from labcal.report.page.output import PageOutput


def twin(
    pictures: "AnyPictures",
    rig: Rig | AnyPath,
    folder: AnyPath | None = None,
    target: AnyTarget | DotPlaces | AnyPath | None = None,
    settings: "TwinSettings | None" = None,
    progress: Progress | None = None,
) -> "Twin":
    """Render a shoot again with its calibrated rig, and tell what simulation does not explain.

    Parameters
    ----------
    pictures : PictureSet, Shoot, path or sequence of paths
        As for :func:`~labcal.correspond.picture_set.open_pictures`, which takes the cameras' names, too.
    rig : Rig or path
    folder : path, optional
        A folder to make: ``twin.json``, a page (``index.html``), renderings and differences (``pictures``),
        and the renderings with noise as a shoot with truth (``shoot``).
    target : AnyTarget, DotPlaces, str or path, optional
        What the pictures show; a shoot brings its own. Of a print that was measured, its dots, or the path of
        ``RIG-dots.json``, which is taken by itself where it lies beside the rig's file.
    settings : TwinSettings, optional
    progress : Progress, optional

    Returns
    -------
    Twin

    Raises
    ------
    UnknownNameError
        There is no target or view of that name.
    InputError
        Pictures, rig or dots cannot be read, do not belong together, or show too little that can be compared.
    OutputError
        The folder exists already, or may not be made.
    DeviceError
        The renderer does not work on this machine.

    Examples
    --------
    >>> import labcal
    >>> found = labcal.twin("shoot", "rig.json", "twin")  # doctest: +SKIP
    >>> [one.kind for one in found.unexplained]  # doctest: +SKIP
    ['print', 'paper']
    """
    from labcal.cameras.rig_file import read_rig
    from labcal.correspond.paths_read import paths_read
    from labcal.correspond.picture_set import open_pictures
    from labcal.guide.twin.making import known_print, made_twin
    from labcal.guide.twin.settings import TwinSettings
    from labcal.report.twin_folder import write_twin
    from labcal.run.claims import FolderOutput, claim_outputs
    from labcal.run.unfinished import unfinished_folder

    how, receiver = settings_of(settings, TwinSettings), progress_of(progress)
    opened = open_pictures(pictures)
    calibrated = rig if isinstance(rig, Rig) else read_rig(as_path(rig))
    given = given_places(target)
    shown = given if isinstance(given, DotPlaces) else dots_beside(rig, opened.target(given, calibrated))
    known = known_print(shown)
    if folder is not None:
        named = [one for one in (rig, target) if isinstance(one, str | os.PathLike)]
        read = paths_read([*named, *opened.given], opened.sources)
        claim_outputs([FolderOutput(as_path(folder))], read, force=how.force)
    photographs = _measured(opened, known.target, how, receiver)
    if folder is None:
        return made_twin(calibrated, photographs, known, how, (None, receiver))
    arguments: Mapping[str, object] = {"pictures": opened.given, "rig": rig, "target": target}
    command = f"twin {calibrated.model_dump_json()} {how.views} {how.spp} {how.draws} {how.seed}"
    with unfinished_folder(as_path(folder), command, force=how.force) as working:
        found = made_twin(calibrated, photographs, known, how, (working, receiver))
        maker = page_maker(_page(opened, rig, target, how), "twin", arguments)
        write_twin(working, found, maker, opened.sources[0].raw)
    return found


def _measured(
    opened: "PictureSet",
    target: AnyTarget,
    how: "TwinSettings",
    receiver: Progress,
) -> "Photographs":
    """Return the pictures of the chosen views, and their dots.

    Raises
    ------
    UnknownNameError, InputError
        There is no such view, or there is no picture.
    """
    from labcal.guide.twin.making import Photographs, chosen_views
    from labcal.guide.twin.ray_noise import lamp_variances, rays_of_shoot
    from labcal.guide.twin.rendered_scene import rendered_scene

    if not opened.sources:
        raise InputError("No picture is given. Give a shoot, or pictures.")
    names = tuple(dict.fromkeys(source.view for source in opened.sources))
    views = chosen_views(names, how.views)
    sources = tuple(source for source in opened.sources if source.view in views)
    rays = None if opened.shoot is None else rays_of_shoot(opened.shoot.folder)
    found = detect(replace(opened, sources=sources), target, workers=how.workers, progress=receiver)
    if opened.shoot is None or rays is None:
        return Photographs(sources, found)
    scene = rendered_scene(opened.shoot.folder)
    if scene is None:
        return Photographs(sources, found, rays)
    lamps = lamp_variances(scene, opened.shoot.folder)
    return Photographs(sources, found, rays, lamps, scene.photometry.bayer)


def _page(
    opened: "PictureSet",
    rig: Rig | AnyPath,
    target: AnyTarget | DotPlaces | AnyPath | None,
    how: "TwinSettings",
) -> "PageOutput":
    """Return the page, which names the command that makes it again, but not where it is."""
    from labcal.guide.twin.settings import TwinSettings
    from labcal.report.page.output import PageOutput

    named = target is None or isinstance(target, str | os.PathLike)
    if isinstance(rig, Rig) or not opened.given or not named:
        return PageOutput("index.html")
    words = ["labcal", "twin", *opened.given, os.fspath(rig), "-o", "DIR"]
    if isinstance(target, str | os.PathLike):
        words += ["--dots" if is_places(target) else "--target", os.fspath(target)]
    words += ["--cameras", opened.endings] if opened.endings else []
    words += ["--raw", opened.raw] if opened.raw else []
    views = ",".join(how.views) if isinstance(how.views, tuple) else how.views
    values = {"views": (views, None)} | {
        name: (getattr(how, name), getattr(TwinSettings(), name)) for name in ("spp", "draws", "seed")
    }
    for name, (value, usual) in values.items():
        words += [] if value == usual else [f"--{name}", str(value)]
    return PageOutput("index.html", command=shlex.join(words), inputs=(*opened.given, rig))
