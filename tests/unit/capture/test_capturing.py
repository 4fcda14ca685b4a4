import json
from pathlib import Path

import numpy as np
import pytest
from capture_stand_ins import SIZE, StandIn, frame_set, picture

from labcal.capture.addresses import parse_address, source_at
from labcal.capture.attendant import DropView
from labcal.capture.capturing import Captured, CaptureRun, capture_shoot
from labcal.capture.settings import CaptureSettings, SourceSettings
from labcal.capture.source import Frame, FrameSet
from labcal.capture.stage import StageView
from labcal.errors import DeviceError, InputError
from labcal.run.progress import NoProgress
from labcal.shoot.dataset import open_shoot
from labcal.shoot.manifest import Role
from labcal.shoot.pictures import write_picture


def taken(source: StandIn, folder: Path, settings: CaptureSettings | None = None, **more: object) -> Captured:
    settings = CaptureSettings(interval_s=0.0) if settings is None else settings
    run = CaptureRun("capture", None, more.get("stage", ()), settings, more.get("ask"))  # type: ignore[arg-type]
    return capture_shoot(source, folder, run, NoProgress())


def test_sets_become_views_with_times_and_devices_on_record(tmp_path: Path) -> None:
    source = StandIn([frame_set("left", "right"), frame_set("left", "right", skew_s=0.01)])
    captured = taken(source, tmp_path / "shoot")
    assert [view.name for view in captured.shoot.views()] == ["view-001", "view-002"]
    assert captured.shoot.manifest.cameras["left"].size == SIZE
    assert source.called == ["open", "skip []", "close"]
    record = json.loads((tmp_path / "shoot" / "capture.json").read_text())
    assert [one["time_s"] for one in record["pictures"]] == [100.0, 100.0, 100.0, 100.01]
    assert record["pictures"][1]["device"] == "stand-in right"
    assert captured.notes == ("left is a stand-in", "right is a stand-in")


def test_a_device_that_fails_is_named_and_the_views_before_are_a_whole_shoot(tmp_path: Path) -> None:
    good = [frame_set("left", "right") for _ in range(3)]
    folder = tmp_path / "shoot"
    with pytest.raises(DeviceError, match=r"unplugged.*3 views taken before are in"):
        taken(StandIn([*good, DeviceError("camera B was unplugged.")]), folder)
    shoot = open_shoot(folder)
    assert [view.name for view in shoot.views()] == ["view-001", "view-002", "view-003"]
    assert sorted(path.name for path in (folder / "images").iterdir()) == [
        f"view-00{view}_{camera}.png" for view in (1, 2, 3) for camera in ("left", "right")
    ]
    source = StandIn([frame_set("left", "right")])
    again = taken(source, folder)
    assert len(again.shoot.views()) == 4
    assert source.called[1] == "skip ['view-001', 'view-002', 'view-003']"


def test_sets_that_are_not_synchronous_are_refused_and_the_late_camera_is_named(tmp_path: Path) -> None:
    sets = [frame_set("left", "right", skew_s=0.06), frame_set("left", "right", skew_s=0.04)]
    captured = taken(StandIn(sets), tmp_path / "shoot")
    assert len(captured.shoot.views()) == 1
    assert captured.refused[0].number == 1
    assert "camera right was taken 60 ms after" in captured.refused[0].reasons[0]


def test_pictures_with_holes_are_never_delivered(tmp_path: Path) -> None:
    holes = FrameSet({"left": Frame(picture())}, refusals=("camera B: 3 pictures in a row had holes",))
    captured = taken(StandIn([holes, frame_set("left", "right")]), tmp_path / "shoot")
    assert [view.name for view in captured.shoot.views()] == ["view-001"]
    assert captured.refused[0].reasons == ("camera B: 3 pictures in a row had holes",)
    with pytest.raises(DeviceError, match=r"5 sets in a row were refused. camera B"):
        taken(StandIn([holes] * 9, live=True), tmp_path / "live")
    with pytest.raises(InputError, match="Every set"):
        taken(StandIn([holes] * 9), tmp_path / "replayed")
    assert not (tmp_path / "live").exists()


def test_a_camera_that_is_missing_or_changes_its_size_is_named(tmp_path: Path) -> None:
    small = FrameSet({"left": Frame(picture()), "right": Frame(picture(size=(16, 24)))})
    sets = [frame_set("left", "right"), frame_set("left"), small]
    captured = taken(StandIn(sets), tmp_path / "shoot")
    assert len(captured.shoot.views()) == 1
    assert [one.reasons for one in captured.refused] == [
        ("no picture of the camera right",),
        ("camera right: the picture is 16 x 24, but those before are 32 x 24",),
    ]


def test_a_stage_names_and_places_the_views_and_says_where_to_move(tmp_path: Path) -> None:
    T = np.eye(4)
    T[2, 3] = 12.5
    stage = (StageView("near", Role.TRAIN, np.eye(4)), StageView("far", Role.TEST, T))
    asked: list[str] = []
    source = StandIn([frame_set("left", "right") for _ in range(5)], live=True)
    captured = taken(source, tmp_path / "shoot", stage=stage, ask=asked.append)
    near, far = captured.shoot.views()
    assert (near.name, near.role, far.name, far.role) == ("near", Role.TRAIN, "far", Role.TEST)
    assert captured.shoot.nominal_poses()["far"] == pytest.approx(T)
    assert asked[1] == "View 2 of 2, 'far': move the stage to 0, 0, 12.5 mm"


def test_a_shoot_without_a_target_asks_for_its_name(tmp_path: Path) -> None:
    shoot = taken(StandIn([frame_set("left", "right")]), tmp_path / "shoot").shoot
    with pytest.raises(InputError, match="Name it"):
        _ = shoot.target
    assert "target=None" in repr(shoot)


class TakesBack:
    """An attendant who takes two views, takes the first one back, and is called away if he is told to."""

    def __init__(self, *, called_away: bool) -> None:
        self.called_away = called_away

    def wait(self, request: str, views: tuple[str, ...]) -> bool | DropView:  # noqa: ARG002 -- the interface
        if self.called_away and views == ("b",):
            raise KeyboardInterrupt
        return DropView("a") if views == ("a", "b") else True

    def dropped(self, view: str) -> None:
        pass

    def heard(self, taken: FrameSet, view: str | None, reasons: tuple[str, ...]) -> None:
        pass


@pytest.mark.parametrize("called_away", [False, True])
def test_a_replay_does_not_deliver_again_a_view_that_was_taken_back(
    tmp_path: Path, *, called_away: bool
) -> None:
    names = [f"{view}_{camera}.png" for view in "abc" for camera in ("left", "right")]
    (tmp_path / "recording").mkdir()
    for number, name in enumerate(names):
        write_picture(tmp_path / "recording" / name, picture(number))
    settings = CaptureSettings(source_settings=SourceSettings(cameras="_left=left,_right=right"))

    def replayed() -> Captured:
        source = source_at(parse_address(f"folder:{tmp_path / 'recording'}"), settings.source_settings)
        run = CaptureRun("capture", None, (), settings, None, attendant=TakesBack(called_away=called_away))
        return capture_shoot(source, tmp_path / "shoot", run, NoProgress())

    if called_away:
        with pytest.raises(KeyboardInterrupt):
            replayed()
        assert [view.name for view in open_shoot(tmp_path / "shoot").views()] == ["b"]
        called_away = False
    captured = replayed()
    assert [view.name for view in captured.shoot.views()] == ["b", "c"]
    assert json.loads((tmp_path / "shoot" / "capture.json").read_text())["dropped"] == ["a"]
