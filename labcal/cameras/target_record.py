"""Description of the target that a rig was calibrated with, as ``rig.json`` keeps it."""

from pydantic import ConfigDict, JsonValue, RootModel


class TargetRecord(RootModel[dict[str, JsonValue]]):
    """Description of a target of any kind: its keys and values as in ``shoot.json``.

    Cameras do not depend on the kinds of targets: :func:`~labcal.targets.kept_target.kept_target` checks it
    and makes a target of it.
    """

    model_config = ConfigDict(frozen=True)

    @property
    def name(self) -> str | None:
        """Name of the target; None if the description has none."""
        name = self.root.get("name")
        return name if isinstance(name, str) else None
