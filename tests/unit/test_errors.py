import pytest

from labcal import errors


def test_the_nearest_name_is_offered() -> None:
    known = ["rings-14x10", "rings-10x8", "paper-13x10"]
    message = str(errors.UnknownNameError("target", "rings-10x9", known))
    assert "Did you mean 'rings-10x8'?" in message
    assert message.startswith("There is no target named 'rings-10x9'.")
    assert message.endswith("Known: paper-13x10, rings-10x8, rings-14x10.")


def test_nothing_is_offered_where_nothing_is_near() -> None:
    assert "Did you mean" not in str(errors.UnknownNameError("target", "qqq", ["rings-10x8"]))


@pytest.mark.parametrize(
    ("kind", "builtin"),
    [
        (errors.InputError, ValueError),
        (errors.InputTypeError, TypeError),
        (errors.OutputError, OSError),
        (errors.DiskFullError, errors.OutputError),
        (errors.DeviceError, RuntimeError),
        (errors.UnknownNameError, errors.InputError),
    ],
)
def test_every_kind_can_be_caught_by_root_and_by_builtin(kind: type, builtin: type) -> None:
    assert issubclass(kind, errors.LabcalError)
    assert issubclass(kind, builtin)
