"""Rehearsal of a rig before anything is bought or printed."""

import os
from dataclasses import replace
from typing import TYPE_CHECKING

from labcal.arguments import settings_of
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.pipeline.pages import page_maker
from labcal.run.progress import Progress, progress_of

if TYPE_CHECKING:
    from labcal.guide.rehearsal.rehearsal import Rehearsal
    from labcal.guide.rehearsal.rig_plan import RigPlan
    from labcal.guide.rehearsal.settings import RehearseSettings
    from labcal.report.page.output import PageOutput


def rehearse(
    plan: "RigPlan | AnyPath",
    folder: AnyPath | None = None,
    settings: "RehearseSettings | None" = None,
    progress: Progress | None = None,
) -> "Rehearsal":
    """Return the errors to expect of a planned rig, and what would lessen them.

    The covariance of the calibration follows from the derivatives of the adjustment at the planned views, and
    the noise of dots from drawn pictures in which the detector measures them. Nothing is rendered unless the
    settings ask for a confirmation.

    Parameters
    ----------
    plan : RigPlan or path
        A plan, the name of one that labcal ships, or the path of a YAML file.
    folder : path, optional
        A folder to make: ``rehearsal.json``, the map (``map.csv``), the planned cameras with their expected
        covariance (``rig.json``), the recommended poses (``poses.csv``), the scene that renders them
        (``scene.yaml``), a page (``index.html``) and, of a confirmation, rendered shoots and calibrations.
    settings : RehearseSettings, optional
    progress : Progress, optional
        Of rendering and detection.

    Returns
    -------
    Rehearsal
        Expected errors in mm over the working volume, recommended views, boards, and limits.

    Raises
    ------
    UnknownNameError
        There is no plan, target or lens of that name.
    InputError
        The plan cannot be read; too few poses show enough of the target; the detector finds next to nothing;
        the views do not determine the cameras; no point of the volume is seen by all; or a confirmation is
        asked for without a folder.
    OutputError
        The folder exists already, or may not be made.
    DeviceError
        A confirmation is asked for, and the renderer does not work on this machine.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> pipeline.rehearse(examples.rig_plan())
    Rehearsal(plan=small, rms=..., calibration=..., limited_by=..., warnings=0)
    """
    from labcal.guide.rehearsal.catalogue import load_rig_plan
    from labcal.guide.rehearsal.rehearsal import rehearsed
    from labcal.guide.rehearsal.rig_plan import RigPlan
    from labcal.guide.rehearsal.settings import RehearseSettings
    from labcal.report.rehearsal_folder import write_rehearsal
    from labcal.run.claims import FolderOutput, claim_outputs
    from labcal.run.unfinished import unfinished_folder

    how, receiver = settings_of(settings, RehearseSettings), progress_of(progress)
    loaded = plan if isinstance(plan, RigPlan) else load_rig_plan(plan)
    if folder is None:
        if how.confirm:
            raise InputError(
                "A confirmation renders pictures, and needs a folder for them. Give `folder`, or leave "
                "`confirm` out."
            )
        return rehearsed(loaded, how.seed)
    command = f"rehearse {loaded.model_dump_json()} {how.seed} {how.confirm} {how.spp}"
    read = [os.fspath(plan)] if isinstance(plan, str | os.PathLike) else []
    claim_outputs([FolderOutput(as_path(folder))], read, force=how.force)
    found = rehearsed(loaded, how.seed)  # what is refused leaves no folder
    with unfinished_folder(as_path(folder), command, force=how.force) as working:
        if how.confirm:
            from labcal.guide.rehearsal.rendered_rig import confirmed

            found = replace(found, confirmation=confirmed(found, working, how, receiver))
        write_rehearsal(working, found, page_maker(_page(plan), "rehearse", {"plan": plan}))
    return found


def _page(plan: "RigPlan | AnyPath") -> "PageOutput":
    """Return the page, which names the command that makes it again, but not where it is."""
    from labcal.report.page.output import PageOutput

    command = f"labcal rehearse {os.fspath(plan)} -o DIR" if isinstance(plan, str | os.PathLike) else ""
    return PageOutput("index.html", command=command)
