"""GenICam cameras by the library's own fake camera, which answers on loopback as a real one would."""

import pytest

from labcal.capture.addresses import Address
from labcal.capture.genicam import GenicamCamera
from labcal.capture.settings import SourceSettings
from labcal.capture.source import opened
from labcal.errors import DeviceError

testing = pytest.importorskip("viva_genicam.testing")
pytestmark = pytest.mark.xdist_group("genicam")  # one fake camera a machine: its port is fixed


def camera(place: str = "127.0.0.1", settings: SourceSettings | None = None) -> GenicamCamera:
    return GenicamCamera(Address("genicam", place, "left"), settings or SourceSettings(timeout_s=2.0))


def many(source: GenicamCamera, count: int) -> None:
    for _ in range(count):
        source.trigger()


def test_pictures_come_with_time_exposure_and_gain() -> None:
    settings = SourceSettings(exposure_us=8000.0, timeout_s=2.0)
    with testing.FakeGigeCamera(width=160, height=120, fps=50), opened(camera(settings=settings)) as source:
        (info,) = source.describe()
        first, second = (source.trigger() for _ in range(2))
    assert info.size == (160, 120)
    assert info.exposure_us == pytest.approx(8000.0)
    assert first is not None
    assert second is not None
    one, other = first.frames["left"], second.frames["left"]
    assert one.picture.shape == (120, 160)
    assert one.number is not None
    assert other.number is not None
    assert other.number > one.number
    assert one.time_s is not None
    assert other.time_s is not None
    assert other.time_s >= one.time_s


def test_a_picture_with_missing_packets_is_taken_again_and_never_handed_on() -> None:
    # Every packet with number 1 of the first blocks is lost, and the camera sends none again.
    dropped = [(block, 1) for block in range(1, 5)]
    fake = testing.FakeGigeCamera(width=160, height=120, fps=50, packet_resend=False, drop_packets=dropped)
    with fake, opened(camera()) as source:
        sets = [source.trigger() for _ in range(3)]
    whole = [one for one in sets if one is not None and one.frames]
    assert whole
    for one in sets:
        assert one is not None
        assert one.frames or "holes" in one.refusals[0]


def test_a_camera_that_does_not_answer_is_told_with_those_that_do() -> None:
    with (
        testing.FakeGigeCamera(width=160, height=120),
        pytest.raises(DeviceError, match=r"'4711'.*127\.0\.0\.1"),
        opened(camera("4711")),
    ):
        pass


def test_a_camera_that_is_unplugged_is_named() -> None:
    fake = testing.FakeGigeCamera(width=160, height=120, fps=50)
    fake.start()
    with opened(camera(settings=SourceSettings(timeout_s=0.5))) as source:
        assert source.trigger() is not None
        fake.stop()
        with pytest.raises(DeviceError, match=r"genicam:127\.0\.0\.1"):
            many(source, 100)
