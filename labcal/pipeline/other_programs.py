"""Files for other programs: cameras and dots converted, pictures undistorted."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from labcal.arguments import settings_of, truth_value
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.progress import Progress, progress_of

if TYPE_CHECKING:
    from labcal.cameras.interop.conversion import Conversion, ConvertSettings
    from labcal.cameras.interop.understanding import Understood
    from labcal.correspond.picture_set import AnyPictures
    from labcal.correspond.undistortion import Undistorted, UndistortSettings


def convert(
    inputs: AnyPath | Sequence[AnyPath],
    output: AnyPath,
    settings: "ConvertSettings | None" = None,
    *,
    force: bool = False,
) -> "Conversion":
    """Convert cameras, or detections, from and to the files of other systems, and read tables of pixels.

    Parameters
    ----------
    inputs : path or sequence of paths
        A file, one a camera, or a folder.
    output : path
        File to write; of COLMAP, a folder. Its ending tells cameras from detections (``.csv``, ``.vnl``);
        tables of pixels are named by `from_format`, and become a ``pixels.csv``.
    settings : ConvertSettings, optional
    force : bool
        Replace what labcal wrote there.

    Returns
    -------
    Conversion
        The files that were written, the unit that was read, and notes.

    Raises
    ------
    InputError
        The files cannot be read, or what is in them cannot be held by the other format.
    OutputError
        The output may not be written.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> examples.rig().save("rig.json")
    >>> done = pipeline.convert("rig.json", "cameras.yaml", pipeline.ConvertSettings(to_format="opencv"))
    >>> done.files, done.cameras
    (['cameras.yaml'], ['left', 'right'])
    >>> round(pipeline.convert("cameras.yaml", "again.json").baseline_mm, 3)
    200.0
    """
    from labcal.cameras.interop.conversion import ConvertSettings, convert_cameras
    from labcal.correspond.interop.conversion import convert_detections, is_of_detections
    from labcal.correspond.interop.pixels.conversion import convert_pixels, is_of_pixels, require_known_format
    from labcal.correspond.paths_read import paths_read

    given = [inputs] if isinstance(inputs, str) or not isinstance(inputs, Sequence) else inputs
    paths, place = [as_path(one) for one in given], as_path(output)
    settings, force = settings_of(settings, ConvertSettings), truth_value(force, "force")
    if not paths:
        raise InputError("No file is given. Give `inputs`: a file, one a camera, or a folder.")
    require_known_format(settings)
    if is_of_pixels(settings):
        return convert_pixels(paths, place, settings, paths_read(paths), force=force)
    converted = convert_detections if is_of_detections([*paths, place]) else convert_cameras
    return converted(paths, place, settings, paths_read([*paths, settings.target]), force=force)


def understand(
    inputs: AnyPath | Sequence[AnyPath], settings: "ConvertSettings | None" = None
) -> "Understood":
    """Read files of cameras, and return what was understood of them: unit, baseline, lens, field of view.

    Parameters
    ----------
    inputs : path or sequence of paths
        A file, one a camera, or a folder; of any format of :func:`convert`.
    settings : ConvertSettings, optional
        What the files do not state.

    Returns
    -------
    Understood
        The cameras, with the corners of their pictures undistorted, and notes.

    Raises
    ------
    InputError
        The files cannot be read, or a setting would be dropped.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> examples.rig().save("rig.json")
    >>> found = pipeline.understand("rig.json")
    >>> found.source, found.unit, round(found.baseline_mm, 3), list(found.cameras)
    ('labcal', 'mm', 200.0, ['left', 'right'])
    """
    from labcal.cameras.interop.conversion import ConvertSettings
    from labcal.cameras.interop.understanding import understood_cameras

    given = [inputs] if isinstance(inputs, str) or not isinstance(inputs, Sequence) else inputs
    if not given:
        raise InputError("No file is given. Give `inputs`: a file, one a camera, or a folder.")
    return understood_cameras([as_path(one) for one in given], settings_of(settings, ConvertSettings))


def undistort(
    model: Rig | AnyPath,
    pictures: "AnyPictures",
    folder: AnyPath,
    settings: "UndistortSettings | None" = None,
    progress: Progress | None = None,
) -> "Undistorted":
    """Make pictures as pinhole cameras in the same places would have taken them, with maps and cameras.

    Parameters
    ----------
    model : Rig or path
        The cameras.
    pictures : PictureSet, Shoot, path or sequence of paths
        As for :func:`~labcal.correspond.picture_set.open_pictures`.
    folder : path
        The folder to appear.
    settings : UndistortSettings, optional
    progress : Progress, optional

    Returns
    -------
    Undistorted
        The pictures that were written, and those that could not be used.

    Raises
    ------
    InputError, OutputError
        As of :func:`~labcal.correspond.undistortion.undistort_pictures`.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> shoot = examples.shoot("shoot")
    >>> done = pipeline.undistort(examples.rig(), shoot, "new", pipeline.UndistortSettings(rectify=True))
    >>> done.images[:2]
    ['images/hand-0_left.png', 'images/hand-0_right.png']
    """
    from labcal.cameras.rig_file import read_rig
    from labcal.correspond.paths_read import paths_read
    from labcal.correspond.picture_set import open_pictures
    from labcal.correspond.undistortion import UndistortSettings, undistort_pictures

    rig = model if isinstance(model, Rig) else read_rig(as_path(model))
    opened = open_pictures(pictures)
    given = [None if isinstance(model, Rig) else model, *opened.given]
    read, place = paths_read(given, opened.sources), as_path(folder)
    how = settings_of(settings, UndistortSettings)
    return undistort_pictures(rig, opened, place, how, read, progress_of(progress))
