"""Cameras by lists: a text file of paths, a folder or a form of names for each; views are in their order."""

from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from labcal.arguments import one_text
from labcal.correspond.name_patterns import ANY
from labcal.correspond.natural_order import in_name_order
from labcal.correspond.picture_lists import LIST, listed_pictures
from labcal.correspond.sources import Source
from labcal.errors import InputError
from labcal.run.names import is_name
from labcal.shoot.pictures import SUFFIXES
from labcal.shoot.raw_pictures import RAW_SUFFIXES, RawFormat
from labcal.wording import clipped, counted, listed


def camera_lists(cameras: Mapping[str, str] | str | None) -> dict[str, str] | None:
    """Return the list or folder of each camera, of ``left=left.txt,right=right.txt``; None for other forms.

    A list ends in .txt; a folder has a slash, ``left=A/,right=B/``, which no name of a camera has; and a form
    of names has a star, ``left=A/L_*.png,right=A/R_*.png``.

    Raises
    ------
    InputError
        Some cameras have lists, and others have not; or a camera has two, or no name.
    """
    if cameras is None or not isinstance(cameras, Mapping | str):
        return None
    parts = cameras.split(",") if isinstance(cameras, str) else []
    pairs = [part.partition("=")[::2] for part in parts]
    if isinstance(cameras, Mapping):
        pairs = [(one_text(key, "cameras"), one_text(value, "cameras")) for key, value in cameras.items()]
    lists = [place for _, place in pairs if _is_place(place)]
    if not lists:
        return None
    names = [name for name, _ in pairs]
    if len(lists) < len(pairs) or len(set(names)) < len(names) or not all(map(is_name, names)):
        raise InputError(
            "With lists `cameras` takes the name of each camera once, of letters, digits and hyphens, and "
            f"its list or folder, as in 'left=left.txt,right=right.txt', but got '{clipped(str(cameras))}'."
        )
    return dict(pairs)


def list_sources(
    given: Sequence[str], lists: Mapping[str, str], raw: RawFormat | None = None
) -> tuple[list[Source], list[str]]:
    """Return the pictures of lists, and words on what is left out.

    The view is the pictures' name where all cameras have the same names; else its number in the lists.

    Parameters
    ----------
    given : sequence of str
        Pictures as given, one by one; those in no list are left out.
    lists : mapping of str to str
        The list or folder of each camera.
    raw : RawFormat, optional
        Pixel format of all pictures; files without a header then count in folders.

    Raises
    ------
    InputError
        A list or folder is not there or has no pictures, they are not equally long, two hold one picture,
        names tell of another order, or a picture is in a list and was not given.
    """
    suffixes = SUFFIXES if raw is None else SUFFIXES | RAW_SUFFIXES
    of = {camera: _pictures(place, suffixes) for camera, place in lists.items()}
    _refuse_unlike_lengths(of, lists)
    _refuse_twice(of, lists)
    views = _views(of, lists)
    known = {_key(image) for image in given}
    missing = [image for images in of.values() for image in images if _key(image) not in known]
    if missing:
        raise InputError(
            f"The lists hold {listed(missing, 3)}, which is not among the pictures given. Give the lists "
            f"or folders themselves as pictures: {' '.join(lists.values())}."
        )
    sources = [
        Source(view, camera, image, None, raw)
        for camera, images in of.items()
        for view, image in zip(views, images, strict=True)
    ]
    taken = {_key(source.image) for source in sources}
    left = [image for image in given if _key(image) not in taken]
    words = [f"{counted(len(left), 'picture')} in none of the lists left out: {listed(left, 3)}."]
    return sorted(sources, key=lambda one: (one.view, one.camera)), words if left else []


def _is_place(text: str) -> bool:
    return text.lower().endswith(LIST) or any(mark in text for mark in ("/", "\\", ANY))


def _key(image: str) -> str:
    """Return what two paths of one file share."""
    return str(Path(image).resolve())


def _pictures(place: str, suffixes: frozenset[str]) -> list[str]:
    path = Path(place)
    if path.is_dir() or (ANY in path.name and path.parent.is_dir()):
        folder, form = (path, ANY) if path.is_dir() else (path.parent, path.name.replace("[", "[[]"))
        entries = [entry for entry in folder.iterdir() if fnmatchcase(entry.name, form)]
        found = sorted(
            (str(entry) for entry in entries if entry.suffix.lower() in suffixes), key=in_name_order
        )
        if not found:
            raise InputError(f"There are no pictures ({', '.join(sorted(suffixes))}) in {place}.")
        return found
    if not path.is_file():
        raise InputError(f"`cameras` names {place}, but no such list or folder is there. Correct the path.")
    return listed_pictures(path)


def _refuse_unlike_lengths(of: Mapping[str, Sequence[str]], lists: Mapping[str, str]) -> None:
    if len({len(images) for images in of.values()}) > 1:
        lengths = [f"{lists[camera]} has {len(images)}" for camera, images in of.items()]
        raise InputError(
            f"Lists of cameras need one picture a view each, in the same order, but {', '.join(lengths)}. "
            "Take out the pictures of views that another camera lacks."
        )


def _refuse_twice(of: Mapping[str, Sequence[str]], lists: Mapping[str, str]) -> None:
    holder: dict[str, str] = {}
    for camera, images in of.items():
        for image in images:
            key = _key(image)
            if key in holder:
                where = " and ".join(dict.fromkeys((holder[key], lists[camera])))
                raise InputError(
                    f"{image} is twice in {where}. A picture is one view of one camera: list it once."
                )
            holder[key] = lists[camera]


def _views(of: Mapping[str, Sequence[str]], lists: Mapping[str, str]) -> list[str]:
    """Return the view of each line: the names that all cameras share, else numbers."""
    names = [[Path(image).stem for image in images] for images in of.values()]
    first = names[0]
    if all(other == first for other in names) and len(set(first)) == len(first):
        return first
    folders = all(Path(place).is_dir() for place in lists.values())
    for other in names[1:]:
        shared = [name for name in first if name in other]
        disordered = set(first) == set(other)
        moments = len(shared) < len(first) / 2 and _same_places(shared, first, other)
        if disordered or (folders and shared and not moments):
            where = " and ".join(lists.values())
            raise InputError(
                f"{where} have pictures of the same names ({listed(shared, 3)}), but not in the same order, "
                "so that their order pairs pictures of unlike names. List them in one order, or, where the "
                "names tell the views, distinguish the cameras by a pattern: `cameras='A/*=left,B/*=right'`."
            )
    digits = max(4, len(str(len(first))))
    return [f"{number:0{digits}d}" for number in range(1, len(first) + 1)]


def _same_places(shared: Sequence[str], first: Sequence[str], other: Sequence[str]) -> bool:
    """Tell whether names that are equal are in the same places, as of pictures of the same moment."""
    return all(first.index(name) == other.index(name) for name in shared)
