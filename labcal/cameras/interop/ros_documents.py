"""Documents of ROS: camera_info files and messages of it, as ``ros2 topic echo`` prints them."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from labcal.cameras.interop.exchange import SourceText
from labcal.cameras.interop.yaml_tree import read_yaml_tree
from labcal.errors import InputError

_BINNING, _ROI = ("binning_x", "binning_y"), "roi"
_MESSAGE_KEYS = {
    "camera_matrix": "k",
    "distortion_coefficients": "d",
    "rectification_matrix": "r",
    "projection_matrix": "p",
}
"""The keys of a message (sensor_msgs/CameraInfo) by those of a file."""
_LAST_OF_A_MESSAGE = "do_rectify:"
_WARNING = re.compile(
    r"^A message was lost!!!\s*total count change:\s?\d+\s*total count:\s?\d+\s*(---)?", re.MULTILINE
)
"""Lines that ``ros2 topic echo`` prints between messages."""


def is_message(text: str) -> bool:
    """Tell whether a text is a message as ``ros2 topic echo`` prints it."""
    return all(re.search(rf"^{key}:", text, re.MULTILINE | re.IGNORECASE) for key in "dkrp")


def contents_of(source: SourceText) -> list[dict[str, Any]]:
    """Return the cameras in a file, with the keys of camera_info files; of several alike, the first one.

    Raises
    ------
    InputError
        A document is damaged, or two of one camera differ.
    """
    texts = re.split(r"^---[ \t\r]*$", _WARNING.sub("---", source.text), flags=re.MULTILINE)
    documents = [text for text in texts if re.search(r"^[^#%\s]", text, re.MULTILINE)] or [source.text]
    # The last message that `ros2 topic echo` prints may be cut off.
    whole = [text for text in documents if is_message(text)] or documents
    if len(whole) > 1 and _LAST_OF_A_MESSAGE in whole[0] and _LAST_OF_A_MESSAGE not in whole[-1]:
        whole = whole[:-1]
    contents = [_document(text, source.path) for text in whole]
    different = [one for at, one in enumerate(contents) if one not in contents[:at]]
    names = {str(one.get("camera_name") or "") for one in different}
    if len(names) < len(different):
        raise InputError(
            f"{source.path} holds {len(contents)} documents that state different cameras of one name. Put "
            "each into a file of its own."
        )
    return different


def _document(text: str, path: Path) -> dict[str, Any]:
    """Return what one document holds."""
    if not is_message(text):
        return read_yaml_tree(text, path)
    content = {str(key).lower(): value for key, value in read_yaml_tree(text, path).items()}
    header = content.get("header")
    name = header.get("frame_id") if isinstance(header, dict) else None
    matrices = {file_key: {"data": content.get(key)} for file_key, key in _MESSAGE_KEYS.items()}
    return matrices | {
        "camera_name": name,
        "image_width": content.get("width"),
        "image_height": content.get("height"),
        "distortion_model": content.get("distortion_model"),
        **{key: content.get(key) for key in (*_BINNING, _ROI)},
    }


def is_of_part(content: Mapping[str, Any]) -> bool:
    """Tell whether the pictures of a camera are smaller than those that its matrix holds for."""
    roi = content.get(_ROI)
    sides = [roi.get(key) for key in ("width", "height")] if isinstance(roi, dict) else []
    whole = [content.get("image_width"), content.get("image_height")]
    parts = [
        side for side, all_of_it in zip(sides, whole, strict=False) if str(side) not in {"0", str(all_of_it)}
    ]
    return bool(parts) or any(str(content.get(key) or 0) not in {"0", "1"} for key in _BINNING)


def note_on_part(content: Mapping[str, Any], path: Path) -> str:
    """Return a note for a camera of whose pictures a part is taken."""
    return (
        f"{path} states binning or a region of interest: its camera is read as of whole pictures of "
        f"{content.get('image_width')} x {content.get('image_height')} px, which its matrix holds for."
    )
