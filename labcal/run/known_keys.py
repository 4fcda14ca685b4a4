"""The keys that a description may have at each place."""

from typing import Any, get_args

from pydantic import BaseModel


def keys_at(model: type[BaseModel], place: tuple[int | str, ...]) -> list[str]:
    """Return the keys that are known at a place, sorted.

    Parameters
    ----------
    model : type
        The model of the whole description.
    place : tuple of int or str
        Keys and positions that lead there, as pydantic tells them: the tag of a union's member may be among
        them.
    """
    here = _models(model)
    for step in place:
        # A position, a name in a mapping and a union's tag lead to no field: the models stay the same.
        deeper = [kind.model_fields[step].annotation for kind in here if step in kind.model_fields]
        here = {found for annotation in deeper for found in _models(annotation)} or here
    return sorted({key for kind in here for key in kind.model_fields})


def _models(annotation: Any) -> set[type[BaseModel]]:  # noqa: ANN401 -- an annotation can be anything
    """Return the models in an annotation, however deep."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return {annotation}
    return {found for part in get_args(annotation) for found in _models(part)}
