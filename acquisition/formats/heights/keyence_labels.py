# SPDX-License-Identifier: MIT
"""The words of Keyence's height CSV in the four languages of its analyser.

Known from public parsers of such files, not from the manufacturer. The encoding follows
the language of the analyser and is recognised by the decoding that yields its words.
"""

from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import named

MARK = "ImageDataCsv"
HEAD_BYTES = 8192
ENCODINGS = ("utf-8-sig", "cp932", "gb18030", "cp1252")
_BOMS = ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))


@dataclass(frozen=True, slots=True)
class Language:
    """The words one language of the analyser uses.

    Attributes:
        name: of the language, in English.
        words: the keys of the header by what they mean, several where versions differ.
        height: the word for heights, as kind of data and above them.
    """

    name: str
    words: MappingProxyType[str, tuple[str, ...]]
    height: str


def _language(name: str, height: str, **words: str) -> Language:
    split = {key: tuple(value.split("|")) for key, value in words.items()}
    return Language(name, MappingProxyType(split), height)


LANGUAGES = (
    _language(
        "English",
        "Height",
        calibration="XY Calibration",
        output="Output image data",
        columns="Horizontal",
        rows="Vertical",
        unit="Unit",
        least="Minimum value|Minimum",
        most="Maximum value|Maximum",
        model="Model",
        measured="Measured date",
        data_name="Measurement data name",
        measurement_mode="Measurement Mode|Measurement mode",
        objective_lens_power="Objective Lens Power|Lens power",
    ),
    _language(
        "German",
        "Höhe",
        calibration="XY-Justierung",
        output="Bilddatenausg.",
        columns="Horizont.",
        rows="Vertikal",
        unit="Einheit",
        least="Mindestwert|Minimalwert",
        most="Höchstwert|Maximalwert",
        model="Modell",
        measured="Gemessenes Datum",
        data_name="Messdatenname",
        measurement_mode="Messmodus",
        objective_lens_power="Objektivvergrößerung",
    ),
    _language(
        "Japanese",
        "高さ",
        calibration="XYキャリブレーション",
        output="出力画像データ",
        columns="横",
        rows="縦",
        unit="単位",
        least="最小値",
        most="最大値",
        model="機種",
        measured="測定日時",
        data_name="測定データ名",
        measurement_mode="測定モード",
        objective_lens_power="倍率",
    ),
    _language(
        "Chinese",
        "高度",
        calibration="XY校准",
        output="输出图像数据",
        columns="水平",
        rows="垂直",
        unit="单位",
        least="最小值",
        most="最大值",
        model="机型",
        measured="测量日期",
        data_name="测量数据名",
        measurement_mode="测量模式",
        objective_lens_power="镜头倍率",
    ),
)
UNIT_WORDS = MappingProxyType({"微米": "um", "纳米": "nm", "毫米": "mm"})


def is_keyence(data: bytes) -> bool:
    """Recognise a Keyence image CSV of any language by its content."""
    head = data[:HEAD_BYTES].replace(b"\x00", b"")  # UTF-16 counts too
    return MARK.encode() in head or b"XY Calibration" in head


def decode_keyence(data: bytes, path: Path) -> tuple[str, str, Language]:
    """Find the encoding and the language of the header.

    Args:
        data: content of the file.
        path: the file, for messages.

    Returns:
        The text with plain line ends, its encoding and its language.

    Raises:
        FormatError: no decoding yields the words of a known language.
    """
    best: tuple[int, str, str, Language] | None = None
    for encoding in _candidates(data):
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        for language in LANGUAGES:
            score = _known_words(text[:HEAD_BYTES], language)
            if language.words["calibration"][0] not in text[:HEAD_BYTES]:
                continue
            if best is None or score > best[0]:
                best = (score, text, encoding, language)
    if best is None:
        raise FormatError(
            f"{named(path)} is a Keyence CSV, but its header is not readable as "
            f"{', '.join(language.name for language in LANGUAGES)}; set the analyser "
            "to one of these and export again"
        )
    _, text, encoding, language = best
    return text.replace("\r\n", "\n").replace("\r", "\n"), encoding, language


def _candidates(data: bytes) -> tuple[str, ...]:
    for mark, encoding in _BOMS:
        if data.startswith(mark):
            return (encoding,)
    if data[1:400:2].count(0) > 0.8 * len(data[1:400:2]):
        return ("utf-16-le",)
    return ENCODINGS


def _known_words(head: str, language: Language) -> int:
    """Count the words of a language in the header."""
    keys = [word for words in language.words.values() for word in words]
    return sum(word in head for word in [*keys, language.height])
