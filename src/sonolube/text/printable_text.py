"""Text of users and of their files as it may be shown: no character of it acts on terminals, pages or figures."""

import re

# C0 and C1 controls but tab and newline, line separators, embeddings and overrides of the direction of writing,
# surrogates (bytes of a file name that are no UTF-8), and what is no character.
_ACTIVE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]")
_MICRO = re.compile(r"(?<=\d )u(?=[mNsVWFHgAPJ](?![a-z]))")


def printable(text: str) -> str:
    r"""Text in which every character that acts rather than prints is written as an escape, such as ``\x1b``.

    Encodable as UTF-8. Tabs and newlines stay.
    """
    return _ACTIVE.sub(lambda match: _escape(match[0]), text)


def active_character(text: str) -> str | None:
    """First character of a text that `printable` escapes, as "U+001B"; None for plain text."""
    match = _ACTIVE.search(text)
    return None if match is None else f"U+{ord(match[0]):04X}"


def _escape(character: str) -> str:
    """Escape of a character in the notation of Python."""
    code = ord(character)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"


def with_micro_sign(text: str) -> str:
    """Text for figures, with units such as um as µm."""
    return _MICRO.sub("µ", text)
