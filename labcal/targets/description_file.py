"""Descriptions of targets as YAML files that every command takes as ``--target``."""

import yaml

from labcal.paths import AnyPath, as_path
from labcal.run.claims import FileOutput
from labcal.run.file_kinds import FileKind
from labcal.run.file_marks import LINE_COMMENT
from labcal.run.outputs import write_file
from labcal.targets.catalogue import AnyTarget

_NEVER_LEFT_OUT = "rings"
"""The key that says None itself."""


def _is_description(content: bytes) -> bool:
    return b"\nname:" in b"\n" + content and (b"\ncols:" in content or b"\nsquares:" in content)


DESCRIPTION_KIND = FileKind("a description of a target", _is_description, LINE_COMMENT)


def description_output(path: AnyPath) -> FileOutput:
    """Return a description as an output of a command."""
    return FileOutput(as_path(path), DESCRIPTION_KIND)


def description_text(target: AnyTarget) -> str:
    """Return the description of a target in YAML."""
    content = {
        key: _plain(value)
        for key, value in target.model_dump(mode="json").items()
        if value is not None or key == _NEVER_LEFT_OUT
    }
    return yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=100)


def write_target(path: AnyPath, target: AnyTarget, *, force: bool = False) -> None:
    """Write the description of a target.

    Parameters
    ----------
    path : str or os.PathLike
        A file in ``.yaml``.
    target : AnyTarget
    force : bool
        Replace a description that labcal wrote.

    Raises
    ------
    OutputError
        The file exists or cannot be written.
    """
    write_file(as_path(path), description_text(target), kind=DESCRIPTION_KIND, force=force)


def _plain(value: object) -> object:
    """Return a value with lists in place of tuples."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    return [_plain(one) for one in value] if isinstance(value, list | tuple) else value
