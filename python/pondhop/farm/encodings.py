"""The text of a file whose encoding nobody wrote down.

UTF-8 is told from all others for certain. The others are told apart by what they say: a text that reads as letters of
one script, next to each other as in words, is taken as that, with a note that names the guess.
"""

from __future__ import annotations

import codecs
import itertools
import unicodedata
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pondhop.farm.features import Notes

MAX_GUESSED_BYTES = 200_000
"""How much of a file is looked at to guess its encoding."""

_LATIN_SIGNS = "\u00b0\u00ba\u00aa\u00b4\u2019"
"""Degree, ordinals and apostrophes, which stand in Latin text without being letters."""

_CHINESE = set(
    "塘池鱼虾蟹号東东西南北中区場场养殖水库甲乙丙丁一二三四五六七八九十大小新老上下左右湖田村名称经度纬编蚌龙鰻鳗"
)
_TRADITIONAL = set("塘池魚蝦蟹號東西南北中區場養殖水庫甲乙丙丁一二三四五六七八九十大小新老上下左右湖田村名稱經度緯編")
_KOREAN = set("양식장지못호어류동서남북번수조연새우장어가나다라마바사아자차이름위도경도")


@dataclass(frozen=True)
class _Encoding:
    """An encoding that producers' programs write without saying so."""

    codec: str
    label: str
    is_expected: Callable[[str], bool]
    frequent: frozenset[str]


def _is_letter_of(*scripts: str) -> Callable[[str], bool]:
    def is_expected(letter: str) -> bool:
        return unicodedata.name(letter, "").startswith(scripts)

    return is_expected


def _is_common_hanzi(letter: str) -> bool:
    """Whether a character is among the 3,755 most used ones, which GB 2312 lists first, or fullwidth punctuation."""
    try:
        lead = letter.encode("gb2312")[0]
    except UnicodeEncodeError:
        return False
    return 0xB0 <= lead <= 0xD7 or lead in {0xA1, 0xA3}


def _is_common_traditional(letter: str) -> bool:
    try:
        lead = letter.encode("big5")[0]
    except UnicodeEncodeError:
        return False
    return 0xA1 <= lead <= 0xC6


def _is_common_japanese(letter: str) -> bool:
    try:
        lead = letter.encode("shift_jis")[0]
    except UnicodeEncodeError:
        return False
    return 0x81 <= lead <= 0x83 or 0x88 <= lead <= 0x97


_DOUBLE_BYTE = (
    _Encoding("gbk", "Chinese (GBK)", _is_common_hanzi, frozenset(_CHINESE)),
    _Encoding("big5", "Chinese (Big5)", _is_common_traditional, frozenset(_TRADITIONAL)),
    _Encoding("cp949", "Korean (EUC-KR)", _is_letter_of("HANGUL SYLLABLE"), frozenset(_KOREAN)),
    _Encoding(
        "cp932", "Japanese (Shift-JIS)", _is_common_japanese, frozenset("池号養殖場水魚南北東西番一二三四五田川新")
    ),
)
_SINGLE_BYTE = (
    _Encoding("cp874", "Thai (Windows-874)", _is_letter_of("THAI"), frozenset("บ่อกุ้งปลาสระที่")),
    _Encoding("cp1251", "Cyrillic (Windows-1251)", _is_letter_of("CYRILLIC"), frozenset("прудыоаеин")),
    _Encoding("cp1256", "Arabic (Windows-1256)", _is_letter_of("ARABIC"), frozenset("الحوضبركةسمك")),
)


def decode(content: bytes, notes: Notes, declared: str | None = None) -> str:
    """Text of a file: UTF-8 with or without a byte order mark, UTF-16, the encoding it declares, else a guess.

    Parameters
    ----------
    content
        The bytes of the file.
    notes
        Get a sentence where the encoding was guessed.
    declared
        The name of the encoding that the file itself gives, as an XML declaration does.
    """
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace")
    for codec, zeros in (("utf-16-le", content[1:400:2]), ("utf-16-be", content[:400:2])):
        if len(zeros) > 8 and zeros.count(0) > 0.9 * len(zeros):
            return content.decode(codec, errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        pass
    if declared is not None:
        try:
            return content.decode(declared)
        except (LookupError, UnicodeDecodeError):
            notes.add(f"The file says that it is {declared[:20]}, which it is not.")
    # Up to the end of a line, so that no letter is cut in two.
    sample, _, _ = content[:MAX_GUESSED_BYTES].rpartition(b"\n")
    codec, label = guess_encoding(
        sample if len(content) > MAX_GUESSED_BYTES and sample else content[:MAX_GUESSED_BYTES]
    )
    notes.add(
        f"The file is not UTF-8; it was read as {label}. If names look wrong, save it as UTF-8 "
        "(in Excel: Save as, CSV UTF-8)."
    )
    return content.decode(codec, errors="replace")


def guess_encoding(content: bytes) -> tuple[str, str]:
    """The codec in which bytes read most like words, and its name for people; else Windows Latin."""
    foreign_words = [word for word in content.split() if not word.isascii()]
    sample = b" ".join(foreign_words)
    found: list[tuple[float, int, _Encoding]] = []
    for order, encoding in enumerate(_DOUBLE_BYTE + _SINGLE_BYTE):
        try:
            text = sample.decode(encoding.codec)
        except UnicodeDecodeError:
            continue
        letters = [letter for letter in text if not letter.isascii()]
        expected = sum(map(encoding.is_expected, letters))
        if expected < 0.95 * len(letters) or (encoding in _SINGLE_BYTE and not _stand_together(text)):
            continue
        frequent = sum(letter in encoding.frequent for letter in letters) / max(1, len(letters))
        found.append((frequent, -order, encoding))
    if _reads_as_vietnamese(sample):
        return "cp1258", "Vietnamese (Windows-1258)"
    if found and not _reads_as_latin(sample):
        best = max(found, key=lambda item: item[:2])[2]
        return best.codec, best.label
    return "cp1252", "Windows Latin (cp1252)"


@dataclass(frozen=True)
class FieldText:
    """The bytes of a text in a field of so many bytes, where a letter may be cut in two if the field is full."""

    content: bytes
    is_full: bool

    def decoded(self, codec: str) -> str | None:
        """The text without what is left of a letter that did not fit; ``None`` for what is no text."""
        try:
            return codecs.getincrementaldecoder(codec)().decode(self.content, final=not self.is_full)
        except UnicodeDecodeError:
            return None


def guess_of_fields(texts: Sequence[FieldText]) -> tuple[str, str] | None:
    """The codec of the fields of a table, and its name for people; ``None`` where they are plain or Windows Latin."""
    foreign = [text for text in texts if not text.content.isascii()]
    if not foreign:
        return None
    as_utf_8 = [text.decoded("utf-8") for text in foreign]
    # What is left of a cut letter tells nothing of itself: one letter at least must be whole.
    if None not in as_utf_8 and not all((text or "").isascii() for text in as_utf_8):
        return "utf-8", "UTF-8"
    whole = [text.content for text in foreign]
    cut = [text.content[:-1] if text.is_full else text.content for text in foreign]
    for values in (whole, cut):
        codec, label = guess_encoding(b"\n".join(values)[:MAX_GUESSED_BYTES])
        if codec != "cp1252":
            return codec, label
    return None


def _stand_together(text: str) -> bool:
    """Whether foreign letters stand beside each other, as in a script of its own, and not among Latin letters."""
    pairs = list(itertools.pairwise(text))
    mixed = sum(
        (a.isascii() and a.isalpha() and not b.isascii()) or (b.isascii() and b.isalpha() and not a.isascii())
        for a, b in pairs
    )
    together = sum(not a.isascii() and not b.isascii() for a, b in pairs)
    return together > mixed


def _reads_as_latin(sample: bytes) -> bool:
    """Whether every accented letter stands beside a plain one and none beside another, as in European words."""
    text = sample.decode("cp1252", errors="replace")
    accented = [index for index, letter in enumerate(text) if not letter.isascii()]
    if not all(text[index].isalpha() or text[index] in _LATIN_SIGNS for index in accented):
        return False
    neighbours = [text[max(index - 1, 0) : index] + text[index + 1 : index + 2] for index in accented]
    beside_plain = sum(any(letter.isascii() and letter.islower() for letter in around) for around in neighbours)
    beside_foreign = sum(any(not letter.isascii() for letter in around) for around in neighbours)
    return beside_plain >= 0.9 * len(accented) and beside_foreign <= 0.1 * len(accented)


def _reads_as_vietnamese(sample: bytes) -> bool:
    """Whether tone marks of Windows-1258 follow vowels, or letters of Vietnamese alone are there."""
    try:
        text = sample.decode("cp1258")
    except UnicodeDecodeError:
        return False
    marks = [index for index, letter in enumerate(text) if unicodedata.combining(letter)]
    has_own_letters = any(letter in "ơưƠƯăĂđĐ" for letter in text)
    has_plain_letters = any(letter.isascii() and letter.isalpha() for letter in text)
    return (
        bool(marks)
        and has_own_letters
        and has_plain_letters
        and all(text[i - 1].lower() in "aăâeêioôơuưy" for i in marks if i > 0)
    )
