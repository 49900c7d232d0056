"""Texts that many values of a results file share: each is written once, and what HDF5 keeps of a value refers to it."""

from __future__ import annotations

import h5py
import numpy as np

GROUP = "texts"
"""Where they stand, away from the variables: readers take whatever stands among these for one."""

REFERENCE = np.dtype([("length", "<u4"), ("heap", "<u8"), ("number", "<u4")])
"""A text of any length as HDF5 stores it: its length, and where in the file's global heap it is (HDF5 File Format
Specification, "Variable-length data")."""

_TEXT = h5py.string_dtype()

_PIECE = 1 << 8
"""Texts in one piece of the file."""

_MOST_KNOWN = 1 << 14
"""Texts that are known again, about."""

_SELDOM = 4
"""Values of one text, on the average, from which on it is worth to share it."""


class SharedTexts:
    """The shared texts of a file.

    A program that changes such a value in place takes it from the others; one that copies or reads the file does not
    see that they are shared.
    """

    def __init__(self, file: h5py.File) -> None:
        self._file = file
        self._written: h5py.Dataset | None = None
        self._known: dict[str, int] = {}
        self._references = np.empty(0, REFERENCE)

    def references(self, values: np.ndarray) -> np.ndarray | None:
        """What HDF5 keeps of texts, of the same shape; None where too few of them are alike."""
        texts = values.ravel().tolist()
        if len(self._known) > _MOST_KNOWN:
            self._known, self._references = {}, self._references[:0]
        new = [text for text in dict.fromkeys(texts) if text not in self._known]
        if len(new) * _SELDOM > len(texts):
            return None
        if new:
            self._write(new)
        places = np.fromiter(map(self._known.__getitem__, texts), np.intp, len(texts))
        return self._references[places].reshape(values.shape)

    def _write(self, new: list[str]) -> None:
        """Write texts as values of a dataset, and take from there what HDF5 keeps of them."""
        if self._written is None:
            group = self._file.create_group(GROUP)
            group.attrs["long_name"] = "texts that values of variables share"
            self._written = group.create_dataset("text", (0,), _TEXT, maxshape=(None,), chunks=(_PIECE,))
        begin = -(-len(self._written) // _PIECE) * _PIECE  # in pieces of their own, which are read once
        self._written.resize((begin + len(new),))
        self._written[begin:] = np.array(new, object)
        content = b"".join(
            self._written.id.read_direct_chunk((place,))[1] for place in range(begin, begin + len(new), _PIECE)
        )
        found = np.frombuffer(content, REFERENCE)[: len(new)]
        self._known |= zip(new, range(len(self._references), len(self._references) + len(new)), strict=True)
        self._references = np.concatenate([self._references, found])
