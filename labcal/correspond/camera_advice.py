"""Advice where ``--cameras`` does not fit names of pictures: what to type, tried on these very pictures."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from labcal.correspond.group_option import folder_option
from labcal.correspond.name_patterns import (
    ANY,
    CAMERA,
    VIEW,
    best_pattern,
    camera_in,
    one_camera_pattern,
    tells_apart,
    view_in,
)
from labcal.run.names import is_name
from labcal.shoot.pictures import is_lossy
from labcal.wording import clipped


def mend_of_endings(image: str, images: Sequence[str], endings: Mapping[str, str]) -> str:
    """Return advice for a picture whose name fits no ending or pattern.

    Parameters
    ----------
    image : str
        The picture.
    images : sequence of str
        All pictures.
    endings : mapping of str to str
        Camera by ending or pattern.
    """
    for patterns in _meant(images, endings):
        plain = not any(mark in pattern for pattern in patterns for mark in ",=")
        if plain and len(patterns) == len(endings) and _works(images, patterns):
            return f"Type `cameras='{_option(patterns)}'`: in a pattern {ANY} stands for the rest."
    fitting = [one for one in images if best_pattern(one, endings) is not None]
    if fitting:
        return "Add an ending or a pattern for it, or give only the pictures that fit."
    return (
        f"An ending is that of the name '{clipped(Path(image).stem)}'; in a pattern {ANY} stands for the "
        f"rest, as in 'left{ANY}=left,right{ANY}=right', or of folders, 'LEFT/{ANY}=left,RIGHT/{ANY}=right'."
    )


def mend_of_twins(first: str, second: str, images: Sequence[str], endings: Mapping[str, str]) -> str:
    """Return advice for two pictures that would be the same view of the same camera.

    Parameters
    ----------
    first, second : str
        The two pictures.
    images : sequence of str
        All pictures.
    endings : mapping of str to str
        Camera by ending or pattern.
    """
    one, other = Path(first), Path(second)
    if one.with_suffix("") == other.with_suffix(""):
        return (
            "If a camera stored each picture in two formats, give those of one, the better one: "
            f"{one.parent / '*'}{min(one, other, key=is_lossy).suffix}"
        )
    if endings:
        below = {_below(pattern): camera for pattern, camera in endings.items()}
        if len(below) == len(endings) and _works(images, below):
            return f"Take their folders into the views: `cameras='{_option(below)}'`."
        named = _each_named(endings)
        if named != endings and _works(images, named):
            return f"Name every camera differently: `cameras='{_option(named)}'`."
        return "Give them different names, or write into the patterns what differs."
    advice = []
    if one.stem == other.stem and len(one.parts) == len(other.parts):
        option = folder_option(_by_folder(one, other, images))
        advice += (
            [] if option is None else [f"their folders are those of cameras, state it: `cameras='{option}'`"]
        )
    alone = one_camera_pattern(images)
    if tells_apart(images, [alone]):
        advice.append(f"one camera took them all, state it: `cameras='{alone}=camera'`")
    return f"If {'; or if '.join(advice)}." if advice else "Give them different names."


def _works(images: Sequence[str], endings: Mapping[str, str]) -> bool:
    """Tell whether all pictures fit, each as a view of its own of its camera, and all patterns are used."""
    if not tells_apart(images, endings):
        return False
    found = [(best_pattern(image, endings) or "", image) for image in images]
    return len({(camera_in(i, p, endings[p]), view_in(i, p)) for p, i in found}) == len(images)


def _option(patterns: Mapping[str, str]) -> str:
    return ",".join(
        pattern if camera == CAMERA else f"{pattern}={camera}" for pattern, camera in patterns.items()
    )


def _each_named(endings: Mapping[str, str]) -> dict[str, str]:
    """Return endings with a camera of its own for each: ``left-1`` and ``left-2`` where two have ``left``."""
    given = list(endings.values())
    return {
        pattern: camera if given.count(camera) == 1 else f"{camera}-{number}"
        for number, (pattern, camera) in enumerate(endings.items(), 1)
    }


def _below(pattern: str) -> str:
    """Return a pattern that takes the folder into the view."""
    text = pattern if any(mark in pattern for mark in (ANY, VIEW, CAMERA)) else ANY + pattern
    return f"{ANY}/{text}"


def _by_folder(one: Path, other: Path, images: Sequence[str]) -> dict[str, list[str]]:
    """Return pictures by the folder in which two of them begin to differ."""
    pairs = zip(one.parts, other.parts, strict=True)
    place = next(place for place, (a, b) in enumerate(pairs) if a != b)
    groups: dict[str, list[str]] = defaultdict(list)
    for image in images:
        parts = Path(image).parts
        groups[parts[place] if len(parts) > place + 1 else ""].append(image)
    return groups


def _meant(images: Sequence[str], endings: Mapping[str, str]) -> Iterator[dict[str, str]]:
    """Yield what may be meant: beginnings, folders, parts of names; also in other letters, or swapped."""
    swapped = {camera: pattern for pattern, camera in endings.items() if is_name(pattern)}
    both = (dict(endings), swapped)
    written = [{_as_written(text, images): camera for text, camera in texts.items()} for texts in both]
    for texts in (*both, *written):
        for form in ("{}", "{}" + ANY, "{}/" + ANY, ANY + "{}" + ANY):
            yield {
                text if ANY in text else form.replace("{}", text.rstrip("/")): camera
                for text, camera in texts.items()
            }


def _as_written(text: str, images: Sequence[str]) -> str:
    """Return a text with the capital and small letters that it has in the path of a picture."""
    plain = text.rstrip(f"{ANY}/")
    for image in images:
        start = image.casefold().find(plain.casefold())
        if plain and start >= 0 and len(image.casefold()) == len(image):
            return image[start : start + len(plain)] + text[len(plain) :]
    return text
