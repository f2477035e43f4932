"""Text of a recording with its encoding detected."""

import codecs
from pathlib import Path

from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import refuse_unreadable
from sonolube.storage.input_files import input_bytes

_MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
_FALLBACK = "cp1252"


def decoded_text(path: Path, *, encoding: str) -> tuple[str, tuple[str, ...]]:
    """Text of a file, with its line ends as they are.

    `caveats`: One where Windows-1252 was assumed.
    """
    with refuse_unreadable(path):
        content = input_bytes(path)
    marked = next((name for mark, name in _MARKS if content.startswith(mark)), "utf-8")
    text = _decoded(content, encoding or marked, path, refuse=bool(encoding) or marked != "utf-8")
    caveats: tuple[str, ...] = ()
    if text is None:
        text = _decoded(content, _FALLBACK, path, refuse=True) or ""
        caveats = (
            "the text is not UTF-8 and was read as Windows-1252; if units or labels look wrong, give text.encoding",
        )
    if not text.strip():
        raise InvalidInput(f"{path}: is empty")
    return text, caveats


def _decoded(content: bytes, encoding: str, path: Path, *, refuse: bool) -> str | None:
    """Decoded text; where the bytes are not of the encoding, refuse them or return None."""
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as failure:
        if not refuse:
            return None
        line = content[: failure.start].count(b"\n") + 1
        raise InvalidInput(f"{path}: line {line}: not {encoding} text; give text.encoding in a mapping") from None
    except (LookupError, UnicodeError) as failure:
        raise InvalidInput(f"{path}: {failure}") from None
