"""Frames into a file: GIF by Pillow, MP4 by imageio-ffmpeg."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.outputs import check_output

SUFFIXES = (".gif", ".mp4", ".png")
"""What a film can be written as; a PNG is its first frame."""

COLORS = 128
"""Colours of one frame of a GIF: lines on white need no more."""


def check_film(path: Path, inputs: Iterable[Path] = ()) -> None:
    """Make sure that a film can be written at `path`, before it is drawn.

    Raises
    ------
    InputError : another kind of file; MP4 without imageio-ffmpeg; the folder is not there; `check_output` refuses it
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(Problem(f"{path} is no kind of film", f"name a file that ends in {', '.join(SUFFIXES)}"))
    if not path.parent.is_dir():
        raise InputError(Problem(f"there is no folder {path.parent}", "make it, or name another with -o"))
    check_output(path, inputs)
    if suffix == ".mp4":
        try:
            import imageio_ffmpeg  # noqa: F401
        except ImportError:
            hint = "pip install 'pounding-cli[video]', or write a GIF: -o FILE.gif"
            raise InputError(Problem("MP4 needs the package imageio-ffmpeg", hint)) from None


def write_film(path: Path, frames: Iterable[np.ndarray], rate: float) -> None:
    """Write frames, each (height, width, 3) bytes, at `rate` a second; `path` says the kind.

    Raises
    ------
    InputError : the file cannot be written
    """
    try:
        {".gif": _gif, ".mp4": _mp4, ".png": _png}[path.suffix.lower()](path, iter(frames), rate)
    except OSError as error:
        raise InputError(Problem(f"cannot write {path}: {error.strerror or error}", "name another file")) from error


def _gif(path: Path, frames: Iterator[np.ndarray], rate: float) -> None:
    from PIL import Image

    pictures = (Image.fromarray(frame).convert("P", palette=Image.Palette.ADAPTIVE, colors=COLORS) for frame in frames)
    first = next(pictures)
    # A GIF counts hundredths of a second.
    duration = 10 * max(1, round(100 / rate))
    first.save(path, save_all=True, append_images=pictures, duration=duration, loop=0)


def _mp4(path: Path, frames: Iterator[np.ndarray], rate: float) -> None:
    import imageio_ffmpeg

    first = next(frames)
    height, width = first.shape[:2]
    writer = imageio_ffmpeg.write_frames(str(path), (width, height), fps=rate, quality=7, macro_block_size=2)
    writer.send(None)  # starts ffmpeg
    try:
        for frame in itertools.chain([first], frames):
            writer.send(np.ascontiguousarray(frame))
    finally:
        writer.close()


def _png(path: Path, frames: Iterator[np.ndarray], rate: float) -> None:
    from PIL import Image

    Image.fromarray(next(frames)).save(path)
