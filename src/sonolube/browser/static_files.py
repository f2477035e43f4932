"""Files of the pages, kept in memory as they are sent: compressed and tagged by content."""

import gzip
from functools import cache
from hashlib import sha256
from importlib.resources import files
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import Final

from starlette.requests import Request
from starlette.responses import Response

_FOLDER: Final = Path(str(files("sonolube.browser"))) / "static"
_KINDS: Final = MappingProxyType(
    {
        ".js": "text/javascript; charset=utf-8",
        ".css": "text/css; charset=utf-8",
        ".html": "text/html; charset=utf-8",
        ".json": "application/json",
        ".svg": "image/svg+xml",
    }
)
_PLAIN: Final = "text/plain; charset=utf-8"
_LEVEL: Final = 6  # of the compression, once a file


async def static_file(request: Request) -> Response:
    """File below `static` of a request, by its path; 404 where there is none, 304 where the browser has it."""
    name = request.path_params["name"]
    if name not in _names():
        return Response("There is no such file.", status_code=404, media_type="text/plain")
    content, compressed, kind, tag = _kept(name)
    headers = {"cache-control": "no-cache", "etag": tag, "vary": "Accept-Encoding"}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return Response(content, media_type=kind, headers=headers)
    return Response(compressed, media_type=kind, headers=headers | {"content-encoding": "gzip"})


@cache
def _names() -> frozenset[str]:
    """Paths of all files, with slashes."""
    return frozenset(path.relative_to(_FOLDER).as_posix() for path in _FOLDER.rglob("*") if path.is_file())


@cache
def _kept(name: str) -> tuple[bytes, bytes, str, str]:
    """Content of a file, read and compressed once."""
    content = (_FOLDER / name).read_bytes()
    kind = _KINDS.get(PurePosixPath(name).suffix, _PLAIN)
    compressed = gzip.compress(content, _LEVEL, mtime=0)
    return content, compressed, kind, f'"{sha256(content).hexdigest()[:16]}"'
