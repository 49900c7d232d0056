"""Read the lines over the numbers of a motion file: time step, count and headings of columns, in many languages."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from pounding_cli.records.units import (
    BRACKETS,
    UNIT_STATEMENT,
    find_acceleration_unit,
    find_quantity,
    find_units,
    is_about_one_number,
    normalize,
)

MAX_ROWS_OF_HEADINGS = 3
"""Lines over the numbers that may hold headings: names, units and components may stand in separate lines."""

MAX_HEADING_LENGTH = 2000
"""Characters of a line that are looked at."""

_LONG_BLANKS = re.compile(r"(\s\s)\s+")
_STEP = (
    r"(?:\bd\s?t\b|\bdelta[ _-]?t\b|[δ∆]\s?t\b|\btime[ _-]?(?:step|incr\w*|interval|spacing)\b|\btimestep\b"
    r"|\b(?:sampl\w*|digiti[sz]\w*)[ _-]*(?:interval|period|step|time|spacing|int\.?)(?:_s)?\b"
    r"|\binter?valo?\s+de\s+(?:muestreo|tiempo|amostragem|(?:la\s+)?digit\w+)|\bpaso(?:\s+de\s+tiempo|\s+temporal|\s+de\s+muestreo)?\b"
    r"|\bpas(?:ul)?\s+de\s+(?:temps|timp|e[sșş]antionare)\b|\bpas\s+d.?[eé]chantillonnage\b|\bintervalle(?:\s+de\s+temps|\s+d.?[eé]chantillonnage)?\b"
    r"|\bintervallo(?:\s+di\s+campionamento|\s+temporale)?\b|\bpasso(?:\s+di\s+campionamento|\s+temporale|\s+de\s+tempo)?\b"
    r"|\bzeit(?:schritt(?:weite)?|inkrement|intervall)\b|\babtast(?:intervall|schritt|zeit|periode)\b"
    r"|[öo]rnekleme\s+(?:aral[ıi][ğg][ıi]|ad[ıi]m[ıi])|zaman\s+(?:aral[ıi][ğg][ıi]|ad[ıi]m[ıi])"
    r"|шаг(?:[а-я ]*)|интервал(?:[а-я ]*)|サンプリング(?:間隔|周期)|時間(?:刻み|間隔)|采样间隔|时间间隔"
    r"|(?:χρονικ[όο]\s+)?β[ήη]μα(?:\s+χρ[όο]νου)?|\bdelta(?=\s*[:=]?\s*(?:0?\.\d+|\d\.\d+e-\d+)\s*(?:s\b|sec|[,;]|\Z))"
    r"|\bstep\b|\bintervall?[oe]?\b|\bpas\b)"
)
_RATE = (
    r"(?:\bsampl\w*[ _-]*(?:rate|freq\w*\.?|hz)|\bsamples?[ _-]*(?:per|/)[ _-]*s\w*|\bfs\b|\bsps\b|\bmps(?=\s*[:=])"
    r"|\b(?:data|scan)[ _-]?rate\b"
    r"|\b(?:muestras|amostras|datos)\s+por\s+segundo|\b(?:frecuencia|vel\w*\.?|tasa|raz[oó]n)\s+de\s+muestreo|\bmuestreo\b|\bfr[ée]quence\s+d.?[ée]chantillonnage"
    r"|\bfrequenza\s+di\s+campionamento|\b(?:abtast|sampling)(?:rate|frequenz)|\b(?:taxa|frequ[êe]ncia)\s+de\s+amostragem"
    r"|[öo]rnekleme\s+(?:frekans\w*|h[ıi]z\w*|oran\w*)|частота\s+(?:дискр|опрос|оцифр|выборк|квант|отсч)[а-я]*|サンプリング(?:周波数|レート)|サンプル周波数|采样(?:频率|率))"
)
_SECONDS = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds", "seg", "segundo", "segundos", "sek", "sekunde"), 1.0),
    **dict.fromkeys(("sekunden", "seconde", "secondes", "secondi", "sn", "saniye", "с", "сек", "секунд", "秒"), 1.0),
    **dict.fromkeys(("ms", "msec", "msecs", "millisecond", "milliseconds", "millisekunden", "мс", "毫秒"), 1e-3),
    **dict.fromkeys(("us", "usec", "microseconds"), 1e-6),
    "ミリ秒": 1e-3,
}
_HERTZ = (
    "hz",
    "hertz",
    "гц",
    "sps",
    "samples/s",
    "samples/sec",
    "samples/second",
    "muestras/s",
    "muestras/seg",
    "1/s",
    "s-1",
)
_UNIT = "|".join(re.escape(name) for name in sorted((*_SECONDS, *_HERTZ), key=len, reverse=True))
_NUMBER = r"(?P<value>[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[ed][-+]?\d+)?)(?![\d.:]|[-/]\d|[a-z]*\d)"
_KEYED = re.compile(
    rf"(?P<key>(?P<step>{_STEP})|(?P<rate>{_RATE}))"
    r"[ _]*(?:[(\[]\s*(?:in\s+)?(?P<inside>[^)\]]*?)\s*[)\]])?[ ,\"']*(?:\.(?!\d)[ ,.\"']*)?(?P<sign>[:=]*)"
    rf"\s*/?\s*(?:{_NUMBER})?\s*(?P<behind>(?:{_UNIT})\b|[a-zа-я%]+)?",
    re.IGNORECASE,
)
_PLAIN_STEP = re.compile(
    rf"(?:(?:\bintervals?\s+of|\bspaced(?:\s+(?:at|by|every))?|\bspacing\s+of|\bevery|(?:points|samples|values)\s+(?:at|@))\s*:?\s*{_NUMBER}\s*"
    r"(?P<behind>secs?|seconds?|s|ms|msec|milliseconds)\b)"
    rf"|{_NUMBER.replace('value', 'before')}\s*(?P<unit>secs?|seconds?|s|ms|msec|milliseconds)\b\.?\s*(?:time\s+)?"
    r"(?:intervals?|spacing|steps?)\b",
    re.IGNORECASE,
)
_PLAIN_RATE = re.compile(rf"{_NUMBER}\s*(?P<behind>hz|hertz|sps|samples\s*(?:/|per)\s*s(?:ec\w*)?)\b", re.IGNORECASE)
_FILTER = re.compile(
    r"filt|pass|corner|cut|pole|band|butter|order|peak|max|frequency\s+of|natural|instrument|hochpass|tiefpass",
    re.IGNORECASE,
)
_COUNT = re.compile(
    r"(?:\bnpts\b|\bn_?data\b|\bnpoints\b|\bsamples\b|\b(?:number|no\.?|num\.?|nr\.?|n[º°o]|#|count)\s*(?:of\s+)?(?:the\s+)?"
    r"(?:data\s*)?(?:points?|pts|samples?|data|values)|\bn[uú]m\w*\.?\s*(?:total\s+)?de\s+(?:muestras|datos|puntos)"
    r"|\b(?:data\s+)?points\b|\bnombre\s+de\s+points|\bnumero\s+(?:di\s+)?(?:campioni|punti|dati)|\banzahl(?:\s+der)?\s+(?:werte|punkte|daten|samples)"
    r"|\bveri\s+say[ıi]s[ıi]|число\s+(?:точек|отсчетов)|データ(?:個)?数)\s*(?:\([^)]*\))?\s*[:=]?\s*(?P<count>\d{1,9})(?![\d.,:/-]*\d)",
    re.IGNORECASE,
)
_COUNT_FIRST = re.compile(
    r"(?<![\d.,-])(?P<count>\d{1,9}) ?(?:data )?(?:points|pts|samples|values)\b(?!\s*(?:per\b|/))", re.IGNORECASE
)
_COUNT_AND_STEP = re.compile(rf"(?P<count>\d{{1,9}})[\s,;]+{_NUMBER}(?P<rest>.*)\Z", re.IGNORECASE)
"""The first line of a DEEPSOIL profile motion, with units: 4000 0.01 g"""

_TIME = re.compile(
    r"(?:t|times?|elapsed\s+time|tiempos?|tempo|temps|zeit|zaman|время|時間|時刻|时间|czas|tid|tijd|vrijeme|χρόνος|s|secs?|seconds?"
    r"|seg|sn|ms|msecs?|milliseconds)(?![a-zà-ÿа-я])(?!.*\b(?:step|increment|interval)\b)",
    re.IGNORECASE,
)
_TIME_UNITS = [
    (re.compile(rf"(?<![a-zа-я])(?:{words})(?![a-zа-я])", re.IGNORECASE), seconds)
    for words, seconds in (
        ("ms|msecs?|milliseconds?|millisekunden|мс|ミリ秒|毫秒", 1e-3),
        ("[uµμ]s|[uµμ]secs?|microseconds?", 1e-6),
        ("mins?|minutes?|minutos?|minuten|мин", 60.0),
        ("h|hrs?|hours?|horas?|stunden", 3600.0),
    )
]
"""Units of times other than seconds, and one of each in seconds."""
_SAMPLE_NUMBER = re.compile(
    r"(?:#|no?\.?|nr\.?|n[º°]|№|num(?:ber|ero|éro)?|index|idx|i|j|k|samples?|samp|points?|pts?|steps?|count(?:er)?|row|line|id|rec"
    r"|unnamed:?\s*0|muestra|punto|paso|[ée]chantillon|campione|nummer|lfd\.?\s*nr\.?|s[ıi]ra|örnek|номер|отсч[её]т|番号|序号|データ番号)"
    r"(?:[\s_.]*(?:no|nr|num|number|index|id|#|de|del|punto|muestra)?\.?)*(?:\s*[(\[]\s*[-#]?\s*[)\]])?\Z",
    re.IGNORECASE,
)
_SPECTRUM = re.compile(r"per[ií]od[oe]?s?\b|freq\w*\b|спектр|周期|sa\b|psa\b", re.IGNORECASE)
_TITLE_OF_A_SPECTRUM = re.compile(
    r"\b(?:response|fourier|power|design|acceleration|amplitude)\s+(?:amplitude\s+)?spectr(?:um|a|al)\b"
    r"|espectro|spettro|\bspectre\b|antwortspektrum|спектр|反応スペクトル|反应谱",
    re.IGNORECASE,
)
_MATCHED_TO_A_SPECTRUM = re.compile(r"match|compatib|target|histor|accelerogra|fitted|adjust|scaled", re.IGNORECASE)
"""Words of a motion that was made to fit a spectrum."""
_COMPONENT = re.compile(
    r"(?:a(?:_?[xyzgneu\d])?|ch(?:an(?:nel)?)?[ _.]*\d+|ug|x|y|z"
    r"|n-?s|e-?w|u-?d|s-?n|w-?e|n|e|v|h[12n]?[enz]?|hn[enz12]|[nse]\d{2}[nsew]|u\(\+\)|n\(\+\)|e\(\+\)|long\w*|tran\w*|vert\w*|up)\b",
    re.IGNORECASE,
)


class StatedStep(NamedTuple):
    """A time step as a line of the header states it.

    seconds : the step [s]; 0 where it cannot be read
    line : the line, from 1
    quote : begin of the line
    """

    seconds: float
    line: int
    quote: str


@dataclass(frozen=True)
class Heading:
    """The heading of one column.

    words : one text a line, the nearest to the numbers last
    lines : numbers of these lines, from 1
    """

    words: tuple[str, ...] = ()
    lines: tuple[int, ...] = ()

    @property
    def text(self) -> str:
        """All its words in one line."""
        return " ".join(word for word in self.words if word)

    @property
    def is_time(self) -> bool:
        """True for the heading of a column of times."""
        return any(_TIME.match(word.strip(" \"'")) for word in self.words) and not self.units

    @property
    def time_unit(self) -> float:
        """The unit of times that it names [s]; 1 for none."""
        for pattern, seconds in _TIME_UNITS:
            if any(pattern.search(word) for word in self.words):
                return seconds
        return 1.0

    @property
    def is_component(self) -> bool:
        """True for the name of a component, NS or x, with or without a unit in brackets."""
        return bool(_COMPONENT.fullmatch(BRACKETS.sub("", self.text).strip(" \"'")))

    @property
    def is_sample_number(self) -> bool:
        """True for the heading of a column of sample numbers, which may be empty."""
        return (not self.is_time and not self.text) or bool(_SAMPLE_NUMBER.match(self.text.strip()))

    @property
    def units(self) -> list[tuple[str, int]]:
        """The units of acceleration that it states, each with its line."""
        return [
            (unit, line)
            for word, line in zip(self.words, self.lines, strict=True)
            for unit in find_units(word, is_heading=True)
        ]

    @property
    def quantity(self) -> str:
        """The quantity that it names: acceleration, velocity, displacement, counts; "" for none."""
        if not self.words:
            return ""
        return "acceleration" if self.units else find_quantity(self.text)

    @property
    def is_of_a_spectrum(self) -> bool:
        """True for the heading of a column of periods, frequencies or spectral accelerations."""
        return any(_SPECTRUM.match(word.strip(" \"'")) for word in self.words)

    @property
    def is_other_quantity(self) -> bool:
        """True for the heading of a column of velocities or displacements."""
        return self.quantity in ("velocity", "displacement")


@dataclass
class Header:
    """Statements of the lines over the numbers.

    steps : time steps
    counts : numbers of samples, with their lines
    headings : one a column; empty where no line is one of headings
    heading_lines : the lines of `headings` (from 1)
    words : the other lines by their number
    """

    steps: list[StatedStep] = field(default_factory=list)
    counts: list[tuple[int, int]] = field(default_factory=list)
    headings: list[Heading] = field(default_factory=list)
    heading_lines: set[int] = field(default_factory=set)
    words: dict[int, str] = field(default_factory=dict)

    @property
    def unit_statements(self) -> list[tuple[str, int]]:
        """Units of acceleration that lines which are no headings of columns state, each with its line."""
        return [(unit, line) for line, words in self.words.items() for unit in find_units(words)]


def read_header(lines: Iterable[tuple[int, str]], width: int) -> Header:
    """Return the statements of the lines over the numbers.

    Parameters
    ----------
    lines : their numbers (from 1) and texts
    width : columns of the numbers below
    """
    header = Header()
    for line, text in lines:
        plain = _LONG_BLANKS.sub(r"\1", text[:MAX_HEADING_LENGTH].strip().lstrip("#%!*/ ").strip())
        if plain:
            header.words[line] = plain
    header.headings, header.heading_lines = _read_headings(header.words, width)
    for line, text in list(header.words.items()):
        if line in header.heading_lines:
            del header.words[line]
            continue
        count_and_step = _COUNT_AND_STEP.match(text)
        if count_and_step and _is_unit_or_step_unit(count_and_step["rest"]):
            seconds = float(count_and_step["value"].replace(",", "."))
            header.counts.append((int(count_and_step["count"]), line))
            header.steps.append(StatedStep(seconds, line, text[:60]))
            header.words[line] = _without_seconds(count_and_step["rest"])
            continue
        header.steps += [StatedStep(seconds, line, text[:60]) for seconds in find_steps(text)]
        count = _find_count(text)
        if count is not None:
            header.counts.append((count, line))
    return header


def find_spectrum_title(header: Header) -> tuple[str, int] | None:
    """Return the line that says that a file is a spectrum, and its number; None where no line does."""
    for line, words in header.words.items():
        if _TITLE_OF_A_SPECTRUM.search(words) and not _MATCHED_TO_A_SPECTRUM.search(words):
            return words, line
    return None


def is_name_of_time(word: str) -> bool:
    """Return whether a word is the heading of a column of times."""
    return bool(_TIME.match(word))


def find_steps(line: str) -> list[float]:
    """Return the time steps [s] that a line of a header says; 0 for one that cannot be read.

    Read are `dt = 0.02`, `Time step: 20 ms`, `#SampleRate(Hz): 50`, `equally spaced at .02 sec`, `200 sps` and others.
    """
    plain = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", normalize(line)).lower().replace("µ", "u")
    steps = []
    for match in _KEYED.finditer(plain):
        is_bare = re.fullmatch(
            r"step|intervall?[oe]?|fs|muestreo|sps|pas|β[ήη]μα|(?:шаг|интервал|paso|passo).*", match["key"].strip()
        )
        if match["value"] is None:
            if match["sign"] and match["step"] and plain[match.end("sign") :].strip(" /"):
                steps.append(0.0)
            continue
        unit = match["behind"] or match["inside"] or ""
        if is_bare and not match["sign"] and unit not in _SECONDS and unit not in _HERTZ:
            continue
        steps.append(_seconds(match["value"], unit, is_rate=match["rate"] is not None))
    if steps:
        return steps
    if spacing := _PLAIN_STEP.search(plain):
        return [_seconds(spacing["value"] or spacing["before"], spacing["behind"] or spacing["unit"], False)]
    if alone := re.fullmatch(rf"{_NUMBER}\s*(?P<behind>{'|'.join(_SECONDS)})\.?", plain.strip()):
        return [_seconds(alone["value"], alone["behind"], False)]
    if not _FILTER.search(plain) and (rate := _PLAIN_RATE.search(plain)):
        return [_seconds(rate["value"], "hz", True)]
    return []


def says_step_or_count(line: str) -> bool:
    """Return whether a line of a header says a time step or a number of samples."""
    return bool(find_steps(line)) or _find_count(line) is not None


def _find_count(line: str) -> int | None:
    """Return the number of samples that a line of a header says; None where it says none."""
    match = _COUNT.search(normalize(line)) or _COUNT_FIRST.search(line)
    is_count = match is not None and not _FILTER.search(line[: match.start()])
    return int(match["count"]) if match is not None and is_count else None


def _is_unit_or_step_unit(rest: str) -> bool:
    """Return whether the words behind a count and a time step are units: of the step, of the values, or both."""
    unit = _without_seconds(rest)
    return bool(rest.strip()) and (not unit or find_acceleration_unit(unit) is not None)


def _without_seconds(rest: str) -> str:
    """Return words without the unit of time that they begin with."""
    return re.sub(r"^\W*(?:s|sec|seconds?)\b\W*", "", rest.strip(), flags=re.IGNORECASE).strip(" ,;()[]")


def _seconds(written: str, unit: str, is_rate: bool) -> float:
    """Return a time step [s] from a number and its unit; 0 where they say none."""
    value = float(written.replace(",", ".").replace("d", "e"))
    name = re.sub(r"\s+", "", unit.strip(" .")).replace("samplesper", "samples/")
    if value <= 0:
        return 0.0
    if name in _HERTZ or name.startswith("samples/") or (is_rate and name not in _SECONDS and value >= 1):
        return float(f"{1.0 / value:.9g}")
    if is_rate and name not in _SECONDS:
        return 0.0
    if name in _SECONDS:
        return float(f"{value * _SECONDS[name]:.12g}")
    return value if not name or not re.match(r"min|hour|h\b|%|k|m", name) else 0.0


def _read_headings(words: dict[int, str], width: int) -> tuple[list[Heading], set[int]]:
    """Return the headings of columns in the lines nearest to the numbers, and their lines."""
    rows = list[tuple[int, list[str]]]()
    for line in sorted(words, reverse=True)[:MAX_ROWS_OF_HEADINGS]:
        cells = split_headings(words[line], width)
        if not cells:
            if rows:
                break
            continue
        rows.append((line, cells))
    if not rows or width < 2:
        return [], set()
    rows.reverse()
    columns = zip(*(cells for _, cells in rows), strict=True)
    lines = tuple(line for line, _ in rows)
    return [Heading(tuple(column), lines) for column in columns], set(lines)


def split_headings(line: str, width: int) -> list[str]:
    """Return a line of a header as one heading a column; empty where it is none of headings."""
    is_keyed = re.match(r"([^,;\t]{1,40}?)[:=]\s*\S", line)
    is_numbered = _SAMPLE_NUMBER.match(re.split(r"[,;\t]", line)[0].strip())
    if width < 2 or (is_keyed and not is_numbered and not re.search(r"[;\t]", line)):
        return []
    for separator in (";", "\t", ",", "|"):
        parts = [part.strip().strip("\"'").strip() for part in line.split(separator)]
        if len(parts) == width + 1 and not parts[-1]:
            parts.pop()
        if len(parts) == width and _looks_like_headings(parts) and not any(map(_is_statement, parts)):
            return parts
    for pattern in (r"\s{2,}", r"\s+(?![(\[])"):
        parts = [part.strip("\"'") for part in re.split(pattern, line.strip())]
        if len(parts) == width and _looks_like_headings(parts, True):
            return parts
    parts = re.findall(r"[^\s(\[]+(?:\s*[(\[][^()\[\]]*[)\]])?", line)
    return parts if len(parts) == width and _looks_like_headings(parts, True) else []


def _looks_like_headings(parts: list[str], by_blanks: bool = False) -> bool:
    """Return whether texts name columns: a time, a sample number, accelerations, components; no sentence."""
    are_names = [_names_column(part) for part in parts]
    if by_blanks:
        if any(map(_is_preposition, parts[:-1])):
            return False  # acceleration in g
        if all(are_names):
            return True
        begins_with_time = bool(_TIME.match(parts[0])) and not _is_preposition(parts[1])
        return begins_with_time and any(are_names[1:]) and len(parts) <= 3
    has_digits = any(sign.isdigit() for part in parts for sign in part)
    if _SPECTRUM.match(parts[0]) and not has_digits:
        return True
    names_quantity = any(
        _TIME.match(part) or find_units(part, is_heading=True) or find_quantity(part) for part in parts
    )
    return names_quantity or all(are_names)


def _is_statement(part: str) -> bool:
    """Return whether a text speaks of the whole file, `Time step 20 ms` or `units = g`, not of one column."""
    return says_step_or_count(part) or bool(UNIT_STATEMENT.match(part)) or is_about_one_number(part)


def _is_preposition(word: str) -> bool:
    """Return whether a word belongs to a sentence, not to a heading."""
    return word.lower() in ("in", "en", "em", "of", "de", "history", "step", "series")


def _names_column(part: str) -> bool:
    """Return whether a text names one column: a time, a sample number, a quantity or a component."""
    outside = BRACKETS.sub("", part).strip()
    return bool(
        _TIME.match(part)
        or _SAMPLE_NUMBER.match(part)
        or find_units(part, is_heading=True)
        or (find_quantity(part) and len(part.split()) <= 4)
        or _COMPONENT.fullmatch(outside)
        or _SPECTRUM.match(part)
        or (not outside and BRACKETS.fullmatch(part))
    )
