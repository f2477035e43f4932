"""Damage to files: bytes flipped, cut, doubled and replaced by what readers of measured files are prone to trust."""

import random
import struct
from collections.abc import Sequence

_NUMBERS = (0, 1, 2, 4, 24, 255, 32766, 32767, 65535, 2**31 - 1, 2**31, 2**32 - 1)
_WORDS = (
    b"nan", b"-inf", b"1e308", b"1e400", b"1e-320", b"0", b"-1", b"No Data", b"0 0 0\n", b";", b",", b"\t", b"\n",
    b"\r", b"\0", b'"', b"#", b"!", b"_", b"1_0", b"END", b"BEGIN", b"[End]", b"[Version] 2.0\n",
    b"# GHZ Z DB R 1e-300\n",
    b"9" * 400, b"\xff" * 8, b"\0" * 8, b"\xff\xff\xff\x7f", b"\x80", b"chunk", b'"Frequency"', "µΩ".encode(),
    "\u0661\u0662".encode(), b"(", b")", b"()", b"[]", b"Directory", b"Mult", b"TDSm",
)  # fmt: skip


def mutated(content: bytes, rng: random.Random, *, others: Sequence[bytes] = ()) -> bytes:
    """Return a file with one to eight places damaged; `others` are files from which pieces are put in."""
    data = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 3, 4, 8))):
        at = rng.randrange(len(data) + 1)
        _damage(data, at, rng.choice((1, 2, 4, 8, 24, 200)), rng, others)
    return bytes(data)


def _damage(data: bytearray, at: int, span: int, rng: random.Random, others: Sequence[bytes]) -> None:
    match rng.randrange(9):
        case 0:
            data[at : at + 1] = bytes([rng.randrange(256)])
        case 1 if at < len(data):
            data[at] ^= 1 << rng.randrange(8)
        case 2 if rng.random() < 0.4:
            del data[at:]
        case 3:
            del data[at : at + span]
        case 4:
            data[at:at] = data[at : at + span]
        case 5:
            data[at : at + 4] = struct.pack(rng.choice("<>") + "I", rng.choice(_NUMBERS))
        case 6:
            data[at : at + 2] = struct.pack(rng.choice("<>") + "H", rng.choice(_NUMBERS) & 0xFFFF)
        case _:
            insert = rng.choice(others)[at:][:4096] if others and rng.random() < 0.2 else rng.choice(_WORDS)
            data[at : at + rng.choice((0, len(insert)))] = insert
