"""LabVIEW's text recordings (LVM): a file header of keys, then segments, each with a header and columns of its own."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar, final

from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import first_lines
from sonolube.measurement.limits import require_channels
from sonolube.measurement.numeric_text import detected_decimal_sign, parse_number
from sonolube.measurement.recordings.lvm_segments import Header, LvmSegment, joined_segments
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawTable
from sonolube.measurement.recordings.text_file import decoded_text

_SIGNATURE = "LabVIEW Measurement"
_END_OF_HEADER = "***End_of_Header***"
_START_SPECIAL = "***Start_Special***"
_END_SPECIAL = "***End_Special***"
_COMMENT = "Comment"
_SEGMENT_KEYS = frozenset(
    {"Channels", "Samples", "Date", "Time", "Notes", "X_Dimension", "X0", "Delta_X", "Y_Unit_Label", _END_OF_HEADER}
)
"""Keys with which the header of a segment can begin, beside others that only follow a blank line."""

NumberedLine = tuple[int, str]


@dataclass(slots=True)
class _Parser:
    """State of the reading of one file: the separator, decimal sign and header of the file, and the segments so far."""

    path: Path
    lines: list[NumberedLine]
    at: int = 0
    separator: str = "\t"
    decimal_sign: str = ""
    header: Header = field(default_factory=lambda: Header(keys={}, line=1))
    segments: list[LvmSegment] = field(default_factory=list)

    def parse(self) -> None:
        """Read all headers and segments; a header of the file may occur again where recordings were appended."""
        first = self.lines[0] if self.lines else (1, "")
        if not first[1].startswith(_SIGNATURE):
            raise InvalidInput(f"{self.path}: line 1: an LVM file begins with {_SIGNATURE!r}, got {first[1][:40]!r}")
        after_blank = True
        while self.at < len(self.lines):
            number, line = self.lines[self.at]
            if not line.strip(" \t,") and not self._is_row_of_missing_values(line):
                after_blank = True
                self.at += 1
            elif line.startswith(_SIGNATURE):
                self._file_header()
            elif self._continues(line, after_blank=after_blank) or not line.strip(" \t,"):
                segment, cells = self.segments[-1], self._cells(line)
                if segment.x_columns == "No" or any(cells[: len(segment.labels)]):  # else only a comment
                    segment.rows.append((number, cells))
                after_blank = False
                self.at += 1
            else:
                self._segment_header()
                after_blank = False

    def _is_row_of_missing_values(self, line: str) -> bool:
        """Whether a line of separators is a sample of a segment without times that has not ended."""
        if not self.segments or self.segments[-1].x_columns != "No" or self.separator not in line:
            return False
        return len(self.segments[-1].rows) < self.segments[-1].stated_samples

    def _cells(self, line: str) -> list[str]:
        """Cells of a line."""
        return [cell.strip() for cell in line.split(self.separator)]

    def _continues(self, line: str, *, after_blank: bool) -> bool:
        """Whether a line is a row of the segment before it, not the beginning of a header."""
        if not self.segments or line.startswith("***"):
            return False
        cells = self._cells(line)
        if not after_blank:
            return cells[0] not in _SEGMENT_KEYS
        value = next((cell for cell in cells if cell), "")
        return parse_number(value, decimal_sign=self.decimal_sign or ("," if "," in value else ".")) is not None

    def _file_header(self) -> None:
        """Read a header of the file; the first one gives separator, decimal sign and start."""
        begins = self.at
        self.at += 1
        header = self._header("the header")
        if header.text("Separator", "Tab").strip().lower() == "comma" or "," in self.lines[begins][1]:
            self.separator, self.at = ",", begins + 1  # the header is written with the same separator
            header = self._header("the header")
        sign = header.text("Decimal_Separator", "." if self.separator == "," else "")
        if sign not in (".", ",", "") or sign == self.separator:
            raise InvalidInput(f"{self.path}: line {header.line}: Decimal_Separator is {sign[:20]!r}")
        self.decimal_sign = sign
        if not self.header.keys:
            self.header = header

    def _header(self, kind: str) -> Header:
        """Keys up to the next end of a header."""
        keys: dict[str, list[str]] = {}
        begins = self.lines[min(self.at, len(self.lines)) - 1][0]
        while self.at < len(self.lines):
            number, line = self.lines[self.at]
            self.at += 1
            if line.startswith(_END_OF_HEADER):
                return Header(keys=keys, line=number)
            key, *cells = self._cells(line)
            if key:
                keys[key] = cells
        raise InvalidInput(f"{self.path}: line {begins}: {kind} has no {_END_OF_HEADER}")

    def _segment_header(self) -> None:
        """Read the header of a segment and its line of labels; begin a segment."""
        header = self._header("a header")
        while self.at < len(self.lines) and not self.lines[self.at][1].strip():
            self.at += 1
        if self.at == len(self.lines):
            raise InvalidInput(f"{self.path}: line {header.line}: no column names follow the header")
        number, line = self.lines[self.at]
        labels = self._cells(line)
        self.at += 1
        while labels and not labels[-1]:
            labels.pop()
        if labels and labels[-1] == _COMMENT:
            labels.pop()
        require_channels(len(labels), self.path, kind="columns")
        times = self.header.text("X_Columns", "One").capitalize()  # that the file holds: No, One or Multi
        self.segments.append(LvmSegment(header=header, labels=labels, line=number, x_columns=times))


@final
class LabviewText:
    """LabVIEW's text recordings (LVM) of any number of segments.

    References
    ----------
    .. [1] NI, Specification for the LabVIEW Measurement File (.lvm), tutorial 4139.
    """

    name: ClassVar[str] = "LabVIEW measurement text"
    suffixes: ClassVar[tuple[str, ...]] = (".lvm",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the first line is that of an LVM file."""
        return first_lines(head)[0].startswith(_SIGNATURE)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Channels of an LVM file; segments with the same channels are concatenated in order.

        Times are those written, with later segments shifted by the difference of the start times in their headers where
        they restart. Channels without any value are left out.
        """
        text, caveats = decoded_text(path, encoding=mapping.text.encoding if mapping else "")
        parser = _Parser(path=path, lines=list(_lines(text)))
        parser.parse()
        header = parser.header
        if not parser.segments:
            raise InvalidInput(f"{path}: line {header.line}: no segment follows the header")
        sign = parser.decimal_sign or detected_decimal_sign(
            cell for segment in parser.segments for _, cells in segment.rows for cell in cells[: len(segment.labels)]
        )
        columns, lines, own = joined_segments(parser.segments, path, decimal_sign=sign, mapping=mapping)
        return RawTable(
            columns=columns, format_name=self.name, lines=lines, begun=header.begun, caveats=(*caveats, *own)
        )


def _lines(text: str) -> Iterator[NumberedLine]:
    """Yield the numbered lines outside special sections."""
    special = False
    for at, line in enumerate(text.splitlines(), start=1):
        if line.startswith(_START_SPECIAL):
            special = True
        if not special:
            yield at, line
        if line.startswith(_END_SPECIAL):
            special = False
