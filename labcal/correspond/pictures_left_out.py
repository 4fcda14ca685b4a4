"""Pictures in folders that are left out, since their format is not read."""

from collections.abc import Sequence
from pathlib import Path

from labcal.correspond.picture_folders import picture_folders
from labcal.shoot.other_formats import CAMERA_RAW, CONVERT_OTHER, EXPORT_RAW, OTHER
from labcal.wording import counted, listed

_SHOWN = 3


def left_out_words(paths: Sequence[str]) -> list[str]:
    """Return a message about pictures in folders whose format is not read, and how to convert them.

    Parameters
    ----------
    paths : sequence of str
        Files and folders as given for pictures; a file that is named is never left out.
    """
    entries = [
        entry
        for given in paths
        if Path(given).is_dir()
        for folder in picture_folders(Path(given))
        for entry in sorted(folder.iterdir())
    ]
    messages = []
    for endings, mend in ((OTHER, CONVERT_OTHER), (CAMERA_RAW, EXPORT_RAW)):
        names = [str(entry) for entry in entries if entry.suffix.lower() in endings]
        if names:
            kinds = ", ".join(sorted({Path(name).suffix.lower() for name in names}))
            messages.append(
                f"{counted(len(names), 'picture')} left out, since files that end in {kinds} are not read: "
                f"{listed(names, _SHOWN)}. {mend}"
            )
    return messages
