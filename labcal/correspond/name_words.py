"""Words in names of pictures: what is a camera's or a device's, and what is a series' or a placement's."""

import re

from labcal.cameras.sides import plain_word, words_in

_CAMERA = {
    plain_word(word)
    for word in (
        "cam", "cams", "camera", "cameras", "kamera", "kameras", "kam", "cámara", "cámaras", "telecamera",
        "telecamere", "webcam", "webcams", "sensor", "eye", "appareil", "aparat", "камера", "相机", "相機",
        "照相机", "摄像头", "摄像机", "カメラ", "카메라",
    )
}  # fmt: skip
_ENDS = ("cam", "camera", "kamera")
_DEVICE = {
    "video", "usb", "dev", "device", "gerat", "geraet", "kinect", "realsense", "zed", "oak", "rpi", "raspi",
    "raspberry", "raspberrypi", "pi", "jetson", "gopro", "hero", "node", "port", "ch", "chan", "channel",
    "kanal", "canal", "basler", "flir", "ids", "ueye", "ximea", "phone", "iphone", "drone", "imager", "unit",
    "client", "host", "serial", "sn", "ip",
}  # fmt: skip
"""Words before a number, whatever it is, that counts cameras where it crosses with the rest of the names."""
_PLACEMENT = {
    plain_word(word)
    for word in (
        "view", "views", "pose", "poses", "frame", "frames", "position", "positions", "placement", "ansicht",
        "vista", "vue", "posición", "posizione", "posição",
    )
}  # fmt: skip
"""Words for one placement of the target, which all cameras see."""
_SERIES = _PLACEMENT | {
    plain_word(word)
    for word in (
        "x", "y", "z", "row", "rows", "col", "column", "columns", "tilt", "pan", "yaw", "pitch", "roll",
        "angle", "deg", "rot", "rotation", "azimuth", "elevation", "theta", "phi", "pos", "shot", "set",
        "series", "session", "take", "run", "day", "week", "night", "morning", "date", "time", "exp",
        "exposure", "gain", "iso", "ev", "bracket", "burst", "aperture", "shutter", "light", "lamp",
        "led", "focus", "zoom", "part", "plane", "height", "distance", "dist", "depth", "step", "level",
        "layer", "stack", "temp", "temperature", "trial", "try", "attempt", "batch", "sequence", "seq",
        "rep", "repeat", "repetition", "loop", "round",
        # German, French, Spanish, Portuguese, Italian
        "tag", "satz", "serie", "reihe", "zeile", "spalte", "messung", "durchgang", "durchlauf", "lauf",
        "aufnahme", "höhe", "hoehe", "abstand", "winkel", "belichtung", "lage", "stufe", "jour", "séance",
        "série", "prise", "hauteur", "essai", "ligne", "colonne", "mesure", "día", "sesión", "toma",
        "altura", "distancia", "fila", "columna", "medida", "dia", "giorno", "sessione", "prova",
        "altezza", "distanza", "riga", "colonna",
    )
}  # fmt: skip
"""Words before a number, or of a folder, that does not count cameras."""
_PICTURE = {
    "img", "image", "images", "pic", "picture", "photo", "bild", "foto", "imagen", "imagem", "immagine",
}  # fmt: skip
"""Words before a number that counts pictures; a camera may have a folder of that name: KITTI's image_02."""
_SOFT = _PICTURE | {"pos", "shot", "time", "lage", "capture", "snapshot"}
"""Words that may mean one placement of the target, or one of a series."""
_UNITS = {
    "us", "µs", "ms", "sec", "min", "nm", "um", "µm", "mm", "cm", "inch", "deg", "grad", "degc", "ev", "lux",
    "lx", "hz", "fps", "ma", "db", "pct", "percent",
}  # fmt: skip
_LETTERS = {"s", "m", "C", "K", "V"}
"""Units of one letter, which numbers that count from 0 or 1 are not taken to have."""
GRIDS = ({"r", "c"}, {"x", "y"}, {"u", "v"}, {"i", "j"}, {"p", "t"})
"""Letters before two numbers that are rows and columns, or the like."""
_VALUE = re.compile(r"[-+]?(?P<number>\d+)(?:[.,]\d+)?[ _-]?(?P<unit>[^\W\d_]+)")
_DAY = r"(?:0[1-9]|[12]\d|3[01])"
_MONTH = r"(?:0[1-9]|1[0-2])"
_DATE = re.compile(
    rf"(?:19|20)\d\d{_MONTH}{_DAY}|{_DAY}{_MONTH}(?:19|20)\d\d|{_MONTH}{_DAY}(?:19|20)\d\d"
    rf"|[0-3]\d{_MONTH}{_DAY}"
)
_DATED = re.compile(
    rf"(?<!\d)(?:(?:19|20)\d\d([-_.]?){_MONTH}\1{_DAY}|(?:19|20)\d\d[-_.]{_MONTH}|[0-3]\d{_MONTH}{_DAY}"
    rf"|{_DAY}([-_.]?){_MONTH}\2(?:19|20)\d\d|{_MONTH}([-_.]?){_DAY}\3(?:19|20)\d\d)(?!\d)|^(?:19|20)\d\d$"
)
_TIME = re.compile(r"(?:[01]\d|2[0-3])[0-5]\d[0-5]\d")
_STAMP = re.compile(r"1[4-9]\d{8}(?:\d{3}){1,3}")
"""Time since 1970 in milliseconds or less."""


def _either(text: str) -> set[str]:
    """Return a word, and its last one: ``calibset`` and ``set`` of ``calibSet``."""
    return {plain_word(text), *words_in(text)[-1:]}


def is_camera_word(text: str) -> bool:
    """Tell whether a word means a camera, as ``cam``, ``Kamera`` and ``telecamera``."""
    return any(word in _CAMERA or word.endswith(_ENDS) for word in _either(text))


def is_device_word(text: str) -> bool:
    """Tell whether a word means a camera or a device that has one, as ``video``, ``usb`` and ``gopro``."""
    return is_camera_word(text) or bool(_either(text) & _DEVICE)


def is_series_word(text: str) -> bool:
    """Tell whether a word means a series, days, exposures or places, so that what it counts is no camera."""
    return bool(_either(text) & _SERIES)


def is_picture_word(text: str) -> bool:
    """Tell whether a word stands before numbers of pictures."""
    return bool(_either(text) & _PICTURE)


def may_be_placement(text: str) -> bool:
    """Tell whether a word may mean one placement of the target, or one picture of a series, as ``shot``."""
    return bool(_either(text) & (_PLACEMENT | _SOFT))


def is_placement_word(text: str) -> bool:
    """Tell whether a word means one placement of the target, as ``view`` and ``pose``."""
    return bool(_either(text) & _PLACEMENT)


def is_unit(text: str, *, counted: bool) -> bool:
    """Tell whether a word behind numbers is their unit, as ``mm``; one letter is none where they count on."""
    return text.casefold() in _UNITS or (text in _LETTERS and not counted)


def is_quantity(text: str) -> bool:
    """Tell whether a text is a number with a unit, as ``300mm``."""
    found = _VALUE.fullmatch(text)
    return found is not None and is_unit(found["unit"], counted=found["number"] in {"0", "1"})


def is_date(text: str) -> bool:
    """Tell whether digits are a date, as 20260503, 03052026 or 260503."""
    return _DATE.fullmatch(text) is not None


def is_dated(text: str) -> bool:
    """Tell whether a folder's name has a date, as 2026-05-03 or calib_20260503."""
    return _DATED.search(text) is not None


def is_time(text: str) -> bool:
    """Tell whether digits may be a time of day, as 101112."""
    return _TIME.fullmatch(text) is not None


def is_stamp(text: str) -> bool:
    """Tell whether digits may be a time since 1970, in milliseconds or less."""
    return _STAMP.fullmatch(text) is not None
