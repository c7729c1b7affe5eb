# SPDX-License-Identifier: MIT
"""What a file format of heights is: a record that each format makes of itself."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.file_access.memory_room import count_cells, require_room
from jointbench.acquisition.file_access.text_files import decode, read_bytes, text_lines
from jointbench.acquisition.formats.columns import Column
from jointbench.acquisition.formats.heights.height_facts import LONGEST
from jointbench.acquisition.records.provenance import Step
from jointbench.acquisition.records.surfaces import Surface

# What lines and words of a text take for each of its bytes, and heights for each cell.
_TEXT_NEEDED, _CELL_NEEDED = 3.0, 36.0


class HeightFile:
    """One file that formats look at; its content is read when it is first asked for.

    Attributes:
        path: of the file.
        label: name of the surface to make.
        origin: what is known of the file, put first into the provenance.
        columns: what the user says its columns hold, None if not given.
    """

    def __init__(
        self, path: Path, label: str, origin: Step, columns: tuple[Column, ...] | None
    ) -> None:
        self.path, self.label = path, label
        self.origin, self.columns = origin, columns
        self._data: bytes | None = None
        self._lines: list[str] | None = None
        self._encoding = ""
        self._half_end = False

    @property
    def data(self) -> bytes:
        """Content of the file.

        Raises:
            BadData: it cannot be read, or does not fit into the memory.
        """
        if self._data is None:
            data = read_bytes(self.path)
            needed = _TEXT_NEEDED * len(data) + _CELL_NEEDED * count_cells(data)
            require_room(self.path, needed)
            self._data = data
        return self._data

    @property
    def lines(self) -> list[str]:
        """Lines of the file as text.

        Raises:
            BadData: it cannot be read, is no text, or does not fit into the memory.
        """
        if self._lines is None:
            end = self.data[-2:].replace(b"\0", b"")[-1:]
            self._half_end = end == b"\r" and b"\n" in self.data
            text, self._encoding = decode(self.data, self.path)
            self._data = None  # as large as the file, as is the text
            self._lines = text_lines(text, self.path)
        return self._lines

    @property
    def encoding(self) -> str:
        """Name of the encoding of `lines`."""
        _ = self.lines
        return self._encoding

    @property
    def half_line_end(self) -> bool:
        """Whether the text ends between the two characters of a line end."""
        _ = self.lines
        return self._half_end


@dataclass(frozen=True, slots=True)
class HeightFormat:
    """One file format of heights.

    Attributes:
        name: one word, ``"gwyddion"``.
        recognise: whether a file has this format; cheap, and never an error for a
            file of another format.
        read: returns the surface of a file, heights in metres; raises `BadData`.
        with_columns: whether it is asked as well where the user states what the columns
            hold, which overrules what the content looks like.
        longest: largest length of a trace, or side of a map, that is believed [m].
    """

    name: str
    recognise: Callable[[HeightFile], bool]
    read: Callable[[HeightFile], Surface]
    with_columns: bool = False
    longest: float = LONGEST

    def takes(self, file: HeightFile) -> bool:
        """Return whether a file has this format."""
        return (file.columns is None or self.with_columns) and self.recognise(file)
