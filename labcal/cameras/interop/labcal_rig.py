"""labcal's own ``rig.json`` among the formats, so that it is read and written like the others."""

from collections.abc import Sequence

from labcal.cameras.interop.exchange import (
    NOTHING_GIVEN,
    Home,
    OutputText,
    ReadOptions,
    ReadRig,
    RigFormat,
    RigTexts,
    SourceText,
)
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import KIND
from labcal.errors import InputError
from labcal.run.json_reading import read_json


def recognises(text: str) -> bool:
    """Tell whether a text is a rig."""
    return '"cameras"' in text and '"T_cam_world"' in text


def read_labcal(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read one ``rig.json``.

    Raises
    ------
    InputError
        It is damaged, or there are several.
    """
    if len(sources) != 1:
        raise InputError("A rig.json holds a whole rig. Give one of them.")
    return ReadRig(read_json(Rig, sources[0].text, f"The rig {sources[0].path}"))


def write_labcal(rig: Rig, _suffix: str) -> RigTexts:
    """Return the text of ``rig.json``."""
    return RigTexts((OutputText("", rig.model_dump_json(indent=2) + "\n"),))


LABCAL = RigFormat(
    "labcal",
    (".json",),
    Home.FILE,
    2**24,
    recognises,
    read_labcal,
    write_labcal,
    KIND.mark,
    options=(),
)
