"""Targets designed for cameras, distance and paper."""

from typing import TYPE_CHECKING

from labcal.arguments import object_of, whole_number
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.progress import Progress, progress_of

if TYPE_CHECKING:
    from labcal.guide.target_design.design import TargetDesign
    from labcal.guide.target_design.question import TargetQuestion


def make_target(
    question: "TargetQuestion",
    output: AnyPath | None = None,
    print_file: AnyPath | None = None,
    *,
    seed: int = 0,
    force: bool = False,
    progress: Progress | None = None,
) -> "TargetDesign":
    """Design a target for cameras at a distance, to be printed on a paper.

    Parameters
    ----------
    question : TargetQuestion
        Cameras, distances, the greatest tilt, paper and kind.
    output : path, optional
        The description to write, in ``.yaml``, which every command takes as its target.
    print_file : path, optional
        The sheet to print, in ``.pdf``: pages of the paper, several where tiles are asked for.
    seed : int
        Of the drawn pictures in which the design is tried.
    force : bool
        Replace what labcal wrote.
    progress : Progress, optional

    Returns
    -------
    TargetDesign
        The target, what the detector made of it in drawn pictures, and the shipped targets that would do.

    Raises
    ------
    InputError
        No target on this paper is found at that distance and tilt, or a name of a file has a wrong ending.
    OutputError
        A file exists or cannot be written.

    Examples
    --------
    >>> from labcal import Camera, make_target
    >>> from labcal.pipeline import TargetQuestion
    >>> import numpy as np
    >>> K = [[1100, 0, 639.5], [0, 1100, 479.5], [0, 0, 1]]
    >>> camera = Camera(K, "pinhole", np.zeros(5), np.eye(4), (1280, 960))
    >>> found = make_target(TargetQuestion({"left": camera}, near_mm=450.0, far_mm=550.0, tilt_max_deg=40.0))
    >>> found.target.pitch_x_mm < 15 and found.least_px > 5
    True
    """
    from labcal.guide.target_design.design import designed
    from labcal.guide.target_design.question import TargetQuestion
    from labcal.run.claims import claim_outputs
    from labcal.targets.artwork import artwork_output
    from labcal.targets.description_file import description_output, write_target
    from labcal.targets.page_artwork import PageSettings, export_pages

    asked = object_of(question, TargetQuestion, "question")
    number = whole_number(seed, "seed", 0)
    outputs = []
    if output is not None:
        if as_path(output).suffix.lower() not in {".yaml", ".yml"}:
            raise InputError(
                f"A description is written as YAML, not as {as_path(output).name}: name it in .yaml."
            )
        outputs.append(description_output(output))
    if print_file is not None:
        if as_path(print_file).suffix.lower() != ".pdf":
            raise InputError(
                f"The sheet is written as PDF, not as {as_path(print_file).name}: name it in .pdf."
            )
        outputs.append(artwork_output(print_file))
    claim_outputs(outputs, [], force=force)
    found = designed(asked, number, progress_of(progress))
    if output is not None:
        write_target(output, found.target, force=force)
    if print_file is not None:
        margin_mm = asked.printer_margin_mm
        export_pages(found.target, print_file, PageSettings(asked.paper, asked.tiles, margin_mm), force=force)
    return found
