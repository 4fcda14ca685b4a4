"""Compiled laboratories that are used for all pictures of a process."""

from dataclasses import dataclass
from functools import lru_cache
from types import ModuleType

from labcal.render.laboratory import Laboratory
from labcal.scene.model import Scene

KEPT = 8
"""Scenes, variants and sizes of film of which a process keeps the laboratory."""


@dataclass(frozen=True)
class Laboratories:
    """The laboratories of one scene, for films of any size.

    What was traced in one before leaves no mark on what is traced next, so sharing it changes no picture.
    """

    mi: ModuleType
    """Mitsuba with the variant in use; it must be in use whenever a laboratory is."""
    scene: Scene
    """The scene as it really stands."""
    seed: int
    """Of the run; the print's own defects are drawn from it."""

    def of_size(self, size: tuple[int, int]) -> Laboratory:
        """Return the laboratory for a film size (px); the height may be that of some rows only."""
        # A scene cannot be hashed, its JSON can.
        return _laboratory(self.mi, self.mi.variant(), self.scene.model_dump_json(), (size, self.seed))


@lru_cache(maxsize=KEPT)
def _laboratory(
    mi: ModuleType,
    variant: str,  # noqa: ARG001 -- tells laboratories apart
    scene: str,
    size_and_seed: tuple[tuple[int, int], int],
) -> Laboratory:
    """Compile a laboratory."""
    return Laboratory(mi, Scene.model_validate_json(scene), *size_and_seed)
