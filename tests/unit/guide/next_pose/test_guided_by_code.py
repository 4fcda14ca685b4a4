from pathlib import Path

from coded_print import SIZE, photographed

from labcal import examples
from labcal.capture.guide_settings import GuideSettings
from labcal.capture.settings import CaptureSettings
from labcal.capture.source import CameraInfo, Frame, FrameSet
from labcal.guide.next_pose.guided_by_code import GuidedByCode
from labcal.pipeline.capturing import planned_capture
from labcal.targets.catalogue import load_target


def test_the_code_of_a_print_begins_the_guide_and_the_views_before_count() -> None:
    guide = GuidedByCode(GuideSettings(wanted_mm=0.5), 1)
    guide.begin((CameraInfo("left", "stand-in", SIZE),))
    assert "square code" in guide.advise().words
    sheet, uncoded = photographed("rings-14x10", 1), photographed("rings-14x10", None)
    (fault,) = guide.judge(FrameSet({"left": Frame(uncoded)}), "view-001")
    assert "no code of a print is read" in fault
    assert guide.advise().faults == (fault,)
    target = load_target("rings-14x10")
    guide.judge(FrameSet({"left": Frame(sheet)}, target=target), "view-002")
    advice = guide.advise()
    assert advice.views == 2
    assert advice.wanted_mm == 0.5
    assert "square code" not in advice.words
    guide.judge(FrameSet({"left": Frame(sheet)}, target=target), "view-003")
    assert guide.advise().views == 3


def test_a_shoot_that_is_replayed_tells_the_target_of_a_guide(tmp_path: Path) -> None:
    shoot = examples.shoot(tmp_path / "shoot")
    settings = CaptureSettings(guide=GuideSettings())
    _, run = planned_capture(f"folder:{shoot.folder}", None, settings, None)
    assert run.target == shoot.target
    (tmp_path / "pictures").mkdir()
    _, run = planned_capture(f"folder:{tmp_path / 'pictures'}", None, settings, None)
    assert run.target is None
    assert isinstance(run.advisor, GuidedByCode)
