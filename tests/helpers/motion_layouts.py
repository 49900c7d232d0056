"""Motion files in the layouts their networks publish, written around synthetic samples, for tests of the readers."""

from __future__ import annotations

import math
from collections.abc import Sequence

DT = 0.02
COUNT = 43
"""Samples: no multiple of any row length, so that the last row is short."""


def samples(peak: float, count: int = COUNT, seed: float = 1.0) -> list[float]:
    """Synthetic samples with peak close to `peak` and both signs; rounded so that five decimals hold them."""
    return [round(peak * math.sin(0.9 * i * seed + seed) * math.exp(-0.01 * i), 5) for i in range(count)]


def rows(values: Sequence[float], form: str, per_line: int) -> str:
    """Values in Fortran's columns: `form` is a Python format such as `10.5f`."""
    cells = [format(value, form) for value in values]
    return "".join("".join(cells[i : i + per_line]) + "\n" for i in range(0, len(cells), per_line))


def at2(values: Sequence[float], unit: str = "G", quantity: str = "ACCELERATION", count: int | None = None) -> str:
    """PEER NGA."""
    return (
        "PEER NGA STRONG MOTION DATABASE RECORD\n"
        "Nowhere-01, 1/2/2003, Test Station, 90\n"
        f"{quantity} TIME SERIES IN UNITS OF {unit}\n"
        f"NPTS=  {count or len(values):5d}, DT=   {DT:.4f} SEC,\n" + rows(values, "15.7E", 5)
    )


def knet(
    counts: Sequence[int],
    scale: str = "3920(gal)/6182761",
    frequency: str = "100Hz",
    duration: str | None = None,
    peak: float | None = None,
) -> str:
    """K-NET: counts with an offset, eight a line."""
    rate = 100.0
    mean = sum(counts) / len(counts)
    if peak is None:
        peak = max(abs(count - mean) for count in counts) * 3920 / 6182761
    return (
        "Origin Time       2006/01/02 03:04:05\n"
        "Lat.              37.100\n"
        "Long.             142.200\n"
        "Depth. (km)       36\n"
        "Mag.              5.7\n"
        "Station Code      TST001\n"
        "Station Lat.      38.0001\n"
        "Station Long.     141.0002\n"
        "Station Height(m) 79\n"
        "Record Time       2006/01/02 03:04:46\n"
        f"Sampling Freq(Hz) {frequency}\n"
        f"Duration Time(s)  {duration or f'{len(counts) / rate:g}'}\n"
        "Dir.              N-S\n"
        f"Scale Factor      {scale}\n"
        f"Max. Acc. (gal)   {peak:.3f}\n"
        "Last Correction   2006/01/02 03:04:31\n"
        "Memo.             \n" + rows(counts, "9d", 8)
    )


def esm(
    values: Sequence[float],
    unit: str = "cm/s^2",
    quantity: str = "ACCELERATION",
    count: int | None = None,
    peak: float | None = None,
) -> str:
    """ESM: the DYNA 1.2 header of 64 lines, then a value a line."""
    largest = max(values, key=abs) if peak is None else peak
    said = {
        "EVENT_NAME": "TEST",
        "EVENT_ID": "TEST-0001",
        "EVENT_DATE_YYYYMMDD": "20030102",
        "EVENT_TIME_HHMMSS": "030405",
        "MAGNITUDE_W": "6.0",
        "NETWORK": "XX",
        "STATION_CODE": "TST",
        "STATION_NAME": "Città di prova",
        "STATION_LATITUDE_DEGREE": "42.000000",
        "STATION_LONGITUDE_DEGREE": "13.000000",
        "STATION_ELEVATION_M": "700",
        "VS30_M/S": "",
        "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": "20030102_030400.000",
        "SAMPLING_INTERVAL_S": f"{DT:.6f}",
        "NDATA": f"{count or len(values)}",
        "DURATION_S": f"{len(values) * DT:.3f}",
        "STREAM": "HNE",
        "UNITS": unit,
        "INSTRUMENT": "sensor = Test [] | digitizer = Test []",
        "INSTRUMENTAL_FREQUENCY_HZ": "",
        "INSTRUMENTAL_DAMPING": "",
        "PGA_CM/S^2": f"{largest:.6f}",
        "TIME_PGA_S": "0.100000",
        "BASELINE_CORRECTION": "BASELINE REMOVED",
        "FILTER_TYPE": "BUTTERWORTH",
        "FILTER_ORDER": "2",
        "LOW_CUT_FREQUENCY_HZ": "0.100",
        "HIGH_CUT_FREQUENCY_HZ": "30.000",
        "HEADER_FORMAT": "DYNA 1.2",
        "DATA_TYPE": quantity,
        "DATA_TIMESTAMP_YYYYMMDD_HHMMSS": "20200102_030405.000",
    }
    filled = [f"{key}: {value}" for key, value in said.items()]
    filled += [f"USER{place}: " for place in range(64 - len(filled))]
    return "\n".join(filled) + "\n" + "".join(f"{value:13.6f}\n" for value in values)


def smc(
    values: Sequence[float],
    kind: str = "2 CORRECTED ACCELEROGRAM",
    count: int | None = None,
    rate: float | None = 1.0 / DT,
    flag: int = 0,
    comments: int = 2,
) -> str:
    """SMC: 11 lines of text, 48 integers, 50 reals, comments, samples in E10.4E1 as `-1.2345E+1`."""
    words = [
        kind, "*", "TEST", "2003  1  2  0304 GMT", "Moment Mag= 6.0", "station =Test Station          component= 90",
        "epicentral dist =  10.0", "inst type=SMA-1  data source = USGS", "Nowhere", "*", "*",
    ]  # fmt: skip
    integers = [-32768] * 48
    integers[1:7] = [2003, 2, 3, 4, 5, 0]
    integers[12], integers[13] = 90, 90
    integers[15], integers[16], integers[17] = comments, len(values) if count is None else count, flag
    unknown = 1.7e38
    reals = [unknown] * 50
    reals[1] = unknown if rate is None else rate
    reals[10], reals[11], reals[12] = 38.0, -122.0, 10.0
    cells = [f"{value:10.3E}".replace("E+0", "E+").replace("E-0", "E-").rjust(10) for value in values]
    return (
        "\n".join(words)
        + "\n"
        + rows(integers, "10d", 8)
        + rows(reals, "15.7E", 5)
        + "".join(f"| comment {place}\n" for place in range(comments))
        + "".join("".join(cells[i : i + 8]) + "\n" for i in range(0, len(cells), 8))
    )


def cosmos_channel(
    values: Sequence[float],
    channel: int = 1,
    quantity: str = "acceleration",
    unit: tuple[str, int] = ("cm/s^2", 4),
    form: tuple[str, str, int] = ("(8F10.5)", "10.5f", 8),
    count: int | None = None,
    step_ms: float = 1000.0 * DT,
) -> str:
    """One channel of a COSMOS file: 13 lines of text, 100 integers, 100 reals, comments, samples."""
    integers = [-999] * 100
    integers[0], integers[1], integers[2] = 2, {"acceleration": 1, "velocity": 2, "displacement": 3}[quantity], unit[1]
    integers[10], integers[39], integers[40:45] = 5, 2003, [2, 1, 2, 3, 4]
    integers[53], integers[75] = 90 * channel, 0
    reals = [-999.0] * 100
    reals[0:3] = [38.0, -122.0, 10.0]
    reals[29], reals[33] = 5.0, 0.005
    reals[61], reals[62] = step_ms, len(values) * step_ms / 1000.0
    words = [
        f"Corrected {quantity}    (Format v01.20 with 13 text lines) Test",
        "Record of nowhere         Earthquake of Thu Jan 2, 2003 03:04 UTC",
        "Hypocenter: 38.000   -122.000   H= 10km(TEST) M=6.0",
        "Origin: 01/02/2003, 03:04:05.0 UTC (TEST)",
        "Statn No: 05-    0  Code:CE-99999  CGS  Test Station",
        "Coords: 38.0000 -122.0000  Site geology:Unknown",
        "Recorder:        s/n:     (  3 Chns of  3 at Sta) Sensor:Test       s/n",
        "Rcrd start time:01/02/2003, 03:04:05.000 UTC (Q= ) RcrdId:(see comment)",
        f"Sta Chan{channel:4d}:{90 * channel:3d} deg (Rcrdr Chan{channel:3d}) Location:",
        "Raw record length =  10.000 sec, Uncor max =    0.000        at    0.000 sec",
        "Processed:                               Max =     0.588 cm/s^2   at   1.000 sec",
        "Record filtered below  0.10 Hz (periods over  10.0 secs)  and above 30.0 Hz",
        "Values used when parameter or data value is unknown/unspecified:   -999, -999.0",
    ]
    fortran, python, per_line = form
    return (
        "\n".join(words)
        + "\n 100 Integer-header values follow on  10 lines, Format= (10I8)\n"
        + rows(integers, "8d", 10)
        + " 100 Real-header values follow on 20 lines , Format = (5F15.6)\n"
        + rows(reals, "15.6f", 5)
        + '   2 Comment line(s) follow, each starting with a "|":\n| made for a test\n| 1 2 3\n'
        + f"{count or len(values):8d} {quantity} pts, approx   1 secs, units={unit[0]} ({unit[1]}),Format={fortran}\n"
        + rows(values, python, per_line)
        + f"End-of-data for Chan  {channel} {quantity}\n"
    )


def csmip_v2_channel(
    values: Sequence[float],
    channel: int = 1,
    label: str = "90 Deg",
    unit: str = "in cm/sec2.",
    count: int | None = None,
    upper: bool = False,
) -> str:
    """One channel of a CSMIP V2 file: 25 lines of text, 100 integers, 100 reals, then three series."""
    words = [f"Corrected accelerogram   99999.CE.TST.--.HN      Chan  {channel}:  {label}     from"]
    words += ["Uncorrected accelerogram data   Processed: 01/02/03, CE test", "NOWHERE EARTHQUAKE", "JANUARY 2, 2003"]
    words += ["99999-TEST-03002.01      Start time: 01/02/03, 03:04:05.0 UTC"]
    words += ["Station No. 99999    38.000N, 122.000W    K2    s/n  123", f"Test Station      Chan  {channel}: {label}"]
    words += [f"{len(values)} points of instrument- and baseline-corrected accel, veloc and displ data", "more words"]
    words += ["words"] * (25 - len(words))
    integers, reals = [0] * 100, [0.0] * 100
    integers[26], integers[52], integers[63], integers[65] = 90, len(values), len(values), len(values)
    reals[60] = DT
    size = count or len(values)
    series = [f"{size:8d} points of accel data equally spaced at  {DT:.3f} sec, {unit} (8f10.5)\n"]
    series += [rows(values, "10.5f", 8)]
    for quantity, own in (("veloc", "cm/sec. "), ("displ", "cm.     ")):
        series += [f"{len(values):8d} points of {quantity} data equally spaced at  {DT:.3f} sec, in {own}(8f10.5)\n"]
        series += [rows([0.5 * value for value in values], "10.5f", 8)]
    text = "\n".join(words) + "\n" + rows(integers, "5d", 16) + rows(reals, "10.3f", 8) + "".join(series)
    text += f"/&  ---------- End of data for channel {channel:2d} ----------\n"
    return text.upper() if upper else text


def geonet_component(values: Sequence[float], name: str = "N10E", corrected: bool = True) -> str:
    """A component of GeoNet's V1A or V2A: 16 lines of text, four of integers, six of reals, samples in ten columns."""
    peak = max(values, key=abs)
    kind = "Corrected" if corrected else "Uncorrected"
    words = [f"{kind} accelerogram 20200101_010203_TEST_20 GNS Science", "Site TEST      42 00 00S  172 00 00E"]
    words += ["Test Centre", "Instrument Basalt_1", "Resolution: 24-bit   Instr Period: 0.0050 s   Damping: 0.700"]
    words += ["Accelerogram 20200101_010203_TEST_20                 Processed 2020 February 01", "Somewhere"]
    words += ["2020 January 01         01:02:03 UT", "Epicentre  42 00 00S 173 00 00E  Bearing S40E  Mw 6.00"]
    words += [f"Number of points  {len(values)}    Duration {DT * len(values):g} sec"]
    words += [f"Instrument corrected data at {DT:.3f} sec intervals"]
    words += ["Band-pass filter transition bands are .10-.25 Hz and 24.50-25.50 Hz"]
    words += [f"Component {name}  Accelerometer Axis"]
    words += [f"Acceleration:  peak   {peak:.5f} mm/s/s at  0.04 sec     rms   {peak / 9:.5f} mm/s/s"]
    words += ["Velocity:      peak   -29.5 mm/s   at  0.04 sec", "Displacement:  peak   9.407 mm     at  0.06 sec"]
    integers, reals = [0] * 40, [0.0] * 60
    integers[30], integers[33:36] = len(values), [len(values)] * 3
    reals[24:26] = [DT, DT]
    series = rows(values, "8.5f" if abs(peak) < 10 else "8.1f", 10) * (3 if corrected else 1)
    return "\n".join(words) + "\n" + rows(integers, "8d", 10) + rows(reals, "8.3f", 10) + series


def asa(channels: Sequence[Sequence[float]], names: Sequence[str] = ("N90E", "N00E", "V"), unit: str = "Gal") -> str:
    """The Mexican ASA 2.0: 109 lines `CLAVE : valor`, then one column a channel."""
    said = {
        "NOMBRE DEL ARCHIVO": "TEST0101.011",
        "CLAVE DE LA ESTACION": "TEST",
        "NUMERO DE CANALES": str(len(channels)),
        "ORIENTACION C1-C6 (rumbo;orientacion)": "/" + "/".join(names),
        "VEL. DE MUESTREO, C1-C6 (muestras/s)": f"/{1 / DT:g}" * len(channels),
        "INTERVALO DE MUESTREO, C1-C6 (s)": f"/{DT:g}".replace("0.", ".") * len(channels),
        "NUM. TOTAL DE MUESTRAS, C1-C6": "".join(f"/{len(channel)}" for channel in channels),
        "ACEL. MAX. (gal), C1-C6": "".join(f"/{max(channel, key=abs)}" for channel in channels),
        "UNIDADES DE LOS DATOS": unit,
    }
    head = ["", "=" * 70, "", "", "", "", "      ARCHIVO ESTANDAR DE ACELERACION", "          version 2.0"]
    head += [f"{key:<42}: {value}" for key, value in said.items()]
    head += [""] * (107 - len(head)) + ["   CANAL-1   CANAL-2   CANAL-3", "   " + "   ".join(names)]
    body = ["".join(f"{value:12.5f}" for value in row) for row in zip(*channels, strict=True)]
    return "\n".join([*head, *body]) + "\n"
