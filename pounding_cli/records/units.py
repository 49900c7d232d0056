"""Units of acceleration as motion files write them: what one is in m/s2, and where a line states one."""

from __future__ import annotations

import math
import re
import unicodedata

from pounding_cli.units import GRAVITY, parse_unit

ACCELERATION_UNITS = {name: parse_unit(name)[0] for name in ("m/s2", "cm/s2", "gal", "mm/s2", "ft/s2", "in/s2")}
ACCELERATION_UNITS = {"g": GRAVITY, **ACCELERATION_UNITS, "mg": 0.001 * GRAVITY}
"""The common units, and one of each in m/s2; other spellings and multiples are read too (`find_acceleration_unit`)."""

BRACKETS = re.compile(r"[(\[]([^()\[\]]*)[)\]]")
"""Words in brackets."""

ACCELERATION_WORD = (
    r"(?:acc(?:el|n|él)?[a-zà-ÿ]*|acel[a-zà-ÿ]*|akz[a-z]*|beschl[a-zäöü]*|ivme[a-zığüşöç]*|i̇vme\w*|przysp[a-z]*"
    r"|versnelling\w*|ubrzanj\w*|zrychlen\w*|ускор[а-я]*|επιταχ\w*|επιτάχ\w*|加速度\w*|شتاب)"
)
"""Acceleration in the languages of the networks."""

_GRAVITY_UNITS = {"g": 1.0, "gs": 1.0, "g's": 1.0, "%g": 0.01, "mg": 1e-3, "millig": 1e-3, "ug": 1e-6, "microg": 1e-6}
_QUANTITIES = {(0.0, 1.0, -2.0): "acceleration", (0.0, 1.0, -1.0): "velocity", (0.0, 1.0, 0.0): "displacement"}
_QUANTITY_WORDS = {
    "velocity": r"\bvel(?:oc\w*)?\b|geschwind\w*|vitesse|\bh[ıi]z[ıi]?\b|скорост\w*|(?<!加)速度",
    "displacement": r"\bdisp(?:l\w*)?\b|\bdespl\w*|d[ée]placement|verschiebung|spostament\w*|перемещ\w*|смещен\w*"
    r"|変位|位移",
    "counts": r"(?<![a-z])counts?(?![a-z])|\bdigits\b",
    "acceleration": ACCELERATION_WORD,
}
_QUANTITY_PATTERNS = {name: re.compile(words, re.IGNORECASE) for name, words in _QUANTITY_WORDS.items()}
_LENGTHS = {
    "nm": 1e-9, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "in": 0.0254, "inch": 0.0254,
    "inches": 0.0254, "ft": 0.3048, "feet": 0.3048, "foot": 0.3048,
}  # fmt: skip

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"
_LENGTH = (
    r"(?P<length>nm|um|mm|cm|dm|km|m|inch(?:es)?|in|ft|feet|foot"
    r"|(?:milli|centi)?met(?:er|re)s?|metros?|metri|m[eè]tres?)"
)
_SECOND = r"(?:s(?:ec(?:onds?|onde|ondo|s)?|eg(?:undos?)?|ek(?:unden?)?|n)?)\.?"
_SQUARED = r"\s*(?:\^|\*\*)?\s*\(?\s*2\s*\)?"
_PER = r"\s*(?:/|\bper\b|\bpro\b|\bpor\b|\bpar\b|\bal\b)\s*"
_SECOND_SQUARED = (
    rf"(?:\(?\s*{_SECOND}{_SQUARED}\s*\)?"
    rf"|\(?\s*{_SECOND}\s*(?:/|[-.*x·]|\bper\b)\s*{_SECOND}\)?"
    rf"|{_SECOND}\s*(?:squared|square|\(?\s*au\s+carr[ée]e?\)?|carr[ée]e?|al\s+cuadrado|ao\s+quadrado|quadrato)"
    r"|(?:square|sq\.?)\s+sec(?:ond)?|quadratsekunde)"
)
_COMPOUND = re.compile(
    rf"(?<![a-z]){_LENGTH}\.?(?:{_PER}{_SECOND_SQUARED}|[\s.*·-]*{_SECOND}\s*(?:\^|\*\*)?\s*\(?\s*-\s*2\s*\)?)(?![\w^])",
    re.IGNORECASE,
)
"""Units that are unmistakable wherever they stand: m/s2, cm/sec/sec, m s-2, metres per second squared."""
_PLAIN_SPELLING = r"(?P<plain>[cm]?m)(?:_|_?per_?|p)?s(?:_|\^|\*\*)?2"
_WEAK = (
    r"(?P<unit>%\s*(?:of\s+)?g|milli[- ]?g(?:al)?|micro[- ]?g|m-?gals?|m-?g|[uµ]g|gals?|g's|gs?|[cm]?m_s_?2"
    r"|[cm]?m(?:_?per_?|p)s2|[cm]?ms\^?2)"
)
_POWER_OF_TEN = r"(?:10\s*\^?\s*-\s*\d|1e-?\d+|0?\.0*1|1\s*/\s*10+|10+)"
# Units that a word or a name may be as well (g, Gal, mg, ms2): read where something says that they are one.
_WEAK_END = r"(?![\w'^*%/]|[-.]\w)(?!(?-i:(?<=G)\s*\.\s*[A-Z]))"
_UNIT_KEY = (
    r"(?:units?|unidad(?:es)?|unit[ée]s?|unit[aà]|einheit(?:en)?|birim[a-zığ]*|unidades?|единиц[а-я]*|ед\.?(?:\s*изм\.?)?"
    r"|単位|单位|jednostk\w*|eenheid|[μu]ονάδ\w*)"
)
UNIT_STATEMENT = re.compile(rf"[^\w]*{_UNIT_KEY}\s*[:=]", re.IGNORECASE)
"""The begin of a line that states the unit of all values: `units = g`."""
_SCALAR = rf"(?:(?P<multiple>10\s*\^?\s*-\s*\d|{_NUMBER}(?:\s*/\s*{_NUMBER})?)\s*[*x·]?\s*)?"
_POWER = rf"(?:(?P<multiple>{_POWER_OF_TEN})\s*[*x·]?\s*)?"
_TENTH = rf"(?:\s*/\s*(?P<part>{_NUMBER}))?"
_IN = r"(?:\b(?:in|en|em|als|σε)|(?<![а-я])в)"
_UNIT_WORDS = r"(?:\s*(?:terms\s+of|(?:fra[cçz]\w*|bruchteil\w*|vielfach\w*)\s+(?:of|de|di|von)|дол(?:ях|и)"
_UNIT_WORDS += rf"|{_UNIT_KEY}(?:\s+(?:of|de|von|di|des))?))?"
_ADJACENT = rf"(?:\b{ACCELERATION_WORD}|\bvalues|\bamplitudes?|\bvalores|\bvaleurs|\bwerte|\bvalori|\bdata)"
_CONTEXTS = [
    # unit: g; Units of acceleration = gal; AmplitudeUnit: gal. DC offset; UNIDADES DE LOS DATOS : Gal
    rf"(?<![a-z]){_UNIT_KEY}(?![a-z])(?:[^\d:=;|]{{0,40}}[:=]+|\s*,|(?:\s+(?:of|in|is|are|de|di|von|the|{ACCELERATION_WORD}))*)\s*[(\[]?"
    rf"\s*(?:(?:s|secs?|seconds?)\s*(?:,|and|&|/)\s*)?{_SCALAR}"
    rf"{_WEAK}{_TENTH}(?![\w'^*%])",
    # fraction of g
    rf"\bfractions?\s+of\s+{_WEAK}{_WEAK_END}",
    # in g; in units of G; en gal
    rf"{_IN}{_UNIT_WORDS}\s+{_SCALAR}{_WEAK}{_TENTH}{_WEAK_END}",
    # acceleration, g; acc_g; Accel mg; ACELERACION GAL
    rf"{_ADJACENT}[\s,;:=_/.-]*(?<=[\s,;:=_/.-]){_WEAK}{_TENTH}{_WEAK_END}",
    rf"{_ADJACENT}\s*[(\[<{{]\s*(?:in\s+)?{_POWER}{_WEAK}{_TENTH}\s*[)\]>}}]",
    # a/g, a(t)/g
    rf"\b[ay](?:\(t\))?\s*/\s*{_WEAK}{_WEAK_END}",
    # g's, %g
    r"(?<![\w./])(?<!\d\s)(?P<unit>g's|%\s*(?:of\s+)?g)(?![\w'])",
    # g units; g cinsinden
    rf"(?<![\w.]){_WEAK}[\s-]+(?:units?|cinsinden)\b",
    # [g], (gal), (in mg)
    rf"[(\[<]\s*(?:in\s+|{_UNIT_KEY}\s*[:=]?\s*)?{_WEAK}{_TENTH}\s*[)\]>]",
]
_WEAK_UNITS = [re.compile(pattern, re.IGNORECASE) for pattern in _CONTEXTS]
_ALONE = re.compile(rf"{_SCALAR}{_WEAK}{_TENTH}\.?", re.IGNORECASE)

_PEAK = re.compile(
    r"(?<![a-z])(?:peaks?|max(?:im\w*|\.)?|min(?:im\w*|\.)?|pga|pgv|rms|mean|median|spitze\w*|cr[êe]te|picc?o|tepe"
    r"|en\s+büyük|пик\w*|макс\w*|最大\w*|峰值\w*|pik|sensitiv\w*|threshold|trigger\w*|umbral|clip\w*|full[- ]?scale"
    r"|range|gain|noise|resolution|lsb|offset|dcoffset|spectral|sensitivity)(?![a-z])",
    re.IGNORECASE,
)
# From such a word on a line speaks of one number.
_CONVERTED = re.compile(
    r"convert\w*|multipl\w*|divid\w*|dividiert|factors?\b|faktor|facteur|\boriginal(?:ly)?\b|scaled\s+by|normali[sz]ed",
    re.IGNORECASE,
)
# A line with such a word speaks of several units, or of a multiple.
_A_NUMBER_BEFORE = re.compile(
    r"(?:^|[\s=:(\[<>~±,;|/x*·])[-+]?(?:\d[\d.,]*|\.\d+)(?:e[-+]?\d+)?(?:\s*\^?\s*-?\s*\d+)?\s*(?:[x*·]\s*)?[(\[]?\s*\Z",
    re.IGNORECASE,
)
_A_NUMBER_BEHIND = re.compile(r"\s*[)\]>]?\s*(?:[:=x*·×]\s*[-+]?[\d.]|[-+]?[\d.]+\s*\Z)", re.IGNORECASE)
_RATIO_BEFORE = re.compile(r"(?:volts?|\bm?v|counts?|digits?|lsb)\s*/\s*\(?\s*\Z", re.IGNORECASE)
_RATIO_BEHIND = re.compile(
    r"\s*[)\]]?\s*(?:/|\bper\b)\s*\(?\s*(?:counts?|digits?|lsb|volts?|m?v|bits?)\b", re.IGNORECASE
)

_SIGNS = {
    **dict.fromkeys("−–—‐‑", "-"), **dict.fromkeys("∕⁄÷", "/"), **dict.fromkeys("⋅∙•", "·"),
    "×": "x", "’": "'",
}  # fmt: skip
_PLAIN_SIGNS = str.maketrans("".join(_SIGNS), "".join(_SIGNS.values()))
_LATIN = {"мм": "mm", "см": "cm", "м": "m", "сек": "s", "с": "s", "厘米": "cm", "毫米": "mm", "米": "m", "秒": "s"}
_FOREIGN_UNIT = re.compile(
    r"(?<![а-яa-z])(мм|см|м|厘米|毫米|米|[cm]?m)(\s*[/·*.]\s*)(сек|с|秒|s(?:ec)?)(?![а-я])", re.IGNORECASE
)


_PERCENT_OF_GRAVITY = re.compile(
    r"(?:%|\b(?:per\s?cent(?:age)?|pct\.?|por\s+ciento|prozent|pour\s?cent))\s*(?:of\s+|de\s+|von\s+)?(?:g\b(?!')|gravity\b)",
    re.IGNORECASE,
)


def _latin_unit(found: re.Match[str]) -> str:
    """Return a unit in Latin letters, of one in Cyrillic or Chinese."""
    length, between, second = found.groups()
    return _LATIN.get(length.lower(), length) + between + _LATIN.get(second.lower(), second)


def normalize(text: str) -> str:
    """Return a text with its units in plain letters: `m/s²`, `㎨`, `м/с2`, `ガル`, `m/s<sup>2</sup>`, `$m/s^{2}$`."""
    text = _PERCENT_OF_GRAVITY.sub("%g", text)
    if text.isascii() and not re.search(r"[$\\{<]", text):
        return text
    plain = unicodedata.normalize("NFKC", text).translate(_PLAIN_SIGNS)
    plain = re.sub(r"μ(?=[a-z])", "u", plain, flags=re.IGNORECASE)
    plain = re.sub(r"</?su[pb]>|\\mathrm|\\text|\\,|[${}]", "", plain)
    plain = re.sub(r"(?i)гал(?![а-я])|ガル|伽", "gal", plain)
    plain = _FOREIGN_UNIT.sub(_latin_unit, plain)
    return re.sub(r"(?<=[/·*.])(\s*)(?:сек|с|秒)(?![а-я])", r"\1s", plain)


def identify_unit(text: str) -> tuple[str, float]:
    """Return what a unit speaks of (acceleration, velocity, displacement, counts, "" if unknown), and one of it in SI.

    The number is 0 where it is unknown.  Read are the names of `ACCELERATION_UNITS` in any case, spellings such as
    `cm/sec/sec`, `m/s^2`, `M S-2`, `м/с²`, `g/10`, and multiples (`0.01 g`; `3920/6182761 gal`, one count
    of a recorder).
    """
    plain = normalize(text).strip().rstrip(".")
    plain = re.sub(r"\A[(\[]\s*(.*?)\s*[)\]]\Z", r"\1", plain)
    found = re.match(rf"{_SCALAR}(?P<rest>[^\d.].*)\Z", plain, re.IGNORECASE)
    if found is None or len(plain) > 100:
        return "", 0.0
    unit = found["rest"].strip()
    part = None
    if tenth := re.fullmatch(rf"([^/]*g)\s*/\s*({_NUMBER})", unit, re.IGNORECASE):
        unit = tenth[1]
        part = tenth[2]
    factor = _ratio(found["multiple"]) / (float(part or 1) or math.inf)
    one = _one_of(unit)
    if one:
        return "acceleration", factor * one
    for words in (unit, unit.lower()):
        try:
            one, dimension = parse_unit(words)
        except ValueError:
            continue
        return _QUANTITIES.get(dimension, ""), factor * one
    return next((name for name, word in _QUANTITY_PATTERNS.items() if word.match(unit)), ""), 0.0


def find_acceleration_unit(text: str) -> float | None:
    """Return one of the unit `text` in m/s2; None where it is no unit of acceleration."""
    quantity, one = identify_unit(text)
    return one if quantity == "acceleration" and 0 < one < math.inf else None


def find_quantity(heading: str) -> str:
    """Return the quantity that a heading names, in words or by its unit: velocity, displacement, counts, ..."""
    plain = normalize(heading)
    for name in ("acceleration", "velocity", "displacement", "counts"):
        if _QUANTITY_PATTERNS[name].search(plain):
            return name
    words = [*BRACKETS.findall(plain), *plain.replace(",", " ").split()[-1:]]
    found = (identify_unit(word)[0] for word in words if word.strip())
    return next((quantity for quantity in found if quantity), "")


def find_units(line: str, is_heading: bool = False) -> list[str]:
    """Return the units of acceleration that a line states for the values below it, each once.

    What stands behind a word such as peak, max or sensitivity, beside a number or in a ratio speaks of that number.
    `g`, `Gal` and `mg` are units where a word or a bracket says so, as they may be a name or a milligram elsewhere.

    is_heading : the line is the heading of one column, in which a unit needs no other word
    """
    plain = re.sub(r"(?<=[a-z])(?=U(?:nits?|NITS?)\b)", " ", normalize(line)).strip().strip("\"'")
    if _ALONE.fullmatch(plain) or (is_heading and re.fullmatch(rf"(?i){_PLAIN_SPELLING}", plain)):
        return [plain] if find_acceleration_unit(plain) else []
    if is_heading and (short := re.fullmatch(rf"(?i)a[xyzg]?_{_WEAK}", plain)):
        return [short["unit"]]
    found: dict[float, str] = {}
    for segment in re.split(r"[;|\t]", plain):
        if _CONVERTED.search(segment):
            continue
        spoken = _PEAK.search(segment)
        part = segment[: spoken.start()] if spoken else segment
        for unit in _units_of_segment(part, segment):
            if factor := find_acceleration_unit(unit):
                found.setdefault(float(f"{factor:.6g}"), unit)
    return list(found.values())


def is_about_one_number(line: str) -> bool:
    """Return whether a line has a unit of acceleration, but beside a number or a word such as peak."""
    plain = normalize(line)
    if find_units(line):
        return False
    weak = r"(?<![a-z'])(?:g|gals?)(?![a-z.])"
    return bool(
        _COMPOUND.search(plain)
        or re.search(rf"(?i)\d\s*{weak}", plain)
        or (_CONVERTED.search(plain) and re.search(rf"(?i){weak}", plain))
        or re.search(rf"(?i)(?:{_PEAK.pattern}).*{weak}", plain)
    )


def _units_of_segment(part: str, segment: str) -> list[str]:
    found = []
    for match in _COMPOUND.finditer(part):
        before = part[: match.start()]
        behind = segment[match.end() :]
        if not _RATIO_BEFORE.search(before) and not _RATIO_BEHIND.match(behind):
            if not _A_NUMBER_BEFORE.search(before):
                if not _A_NUMBER_BEHIND.match(behind):
                    found.append(_strip_closing_bracket(match[0]))
            elif multiple := _stated_multiple(before):
                found.append(f"{multiple} {_strip_closing_bracket(match[0])}")
    for pattern in _WEAK_UNITS:
        for match in pattern.finditer(part):
            groups = match.groupdict()
            is_letter_in_bracket = groups["unit"] == "G" and pattern is _WEAK_UNITS[-1]
            if is_letter_in_bracket and not re.search(rf"(?i){_ADJACENT}|units?|\bt(?:ime)?\b", segment):
                continue  # Garage (G)
            behind = segment[match.end() :]
            if _A_NUMBER_BEHIND.match(behind) or _RATIO_BEHIND.match(behind):
                continue
            multiple = f"{groups['multiple']} " if groups.get("multiple") else ""
            part_of = f"/{groups['part']}" if groups.get("part") else ""
            found.append(f"{multiple}{groups['unit'].strip()}{part_of}")
    return found


def _stated_multiple(before: str) -> str | None:
    """Return the multiple that ends a text such as `Units: 0.01 ` or `acceleration (1e-3 `, before a unit."""
    stated = re.search(
        rf"(?i)(?:{_UNIT_KEY}(?![a-z])[^\d]{{0,40}}?[:=]\s*({_NUMBER})|{_ADJACENT}\s*[(\[]\s*({_POWER_OF_TEN}))\s*[*x·]?\s*\Z",
        before,
    )
    return stated and (stated[1] or stated[2])


def _strip_closing_bracket(unit: str) -> str:
    """Return a unit without the bracket that closes behind it."""
    unit = unit.strip()
    return unit.rstrip(") ") if unit.count(")") > unit.count("(") else unit


def _ratio(text: str | None) -> float:
    """Return a number, a fraction or a power of ten as written; 1 for none."""
    if not text:
        return 1.0
    if power := re.fullmatch(r"10\s*\^?\s*-\s*(\d)", text):
        return 10.0 ** -int(power[1])
    above, _, below = text.partition("/")
    return float(above) / (float(below or 1) or math.inf)


def _one_of(unit: str) -> float:
    """Return one of a unit of acceleration in m/s2, 0 where it is none."""
    plain = re.sub(r"\s*of\s+", "", unit.lower())
    short = re.sub(r"[\s-]", "", plain)
    if short in _GRAVITY_UNITS:
        return _GRAVITY_UNITS[short] * GRAVITY
    if re.fullmatch(r"(?:m|milli)?gals?", short):
        return 1e-5 if short.startswith("m") else 0.01
    if found := re.fullmatch(_PLAIN_SPELLING, short):
        return _LENGTHS[found["plain"]]
    if found := _COMPOUND.fullmatch(plain):
        return _length(found["length"])
    return 0.0


def _length(word: str) -> float:
    if word in _LENGTHS:
        return _LENGTHS[word]
    return {"milli": 1e-3, "centi": 1e-2}.get(word[:5], 1.0)
