"""Requests and answers as JSON: the object of a request within its size, answers, and refusals."""

import json
from collections.abc import Mapping
from typing import Any, Final

from starlette.requests import Request
from starlette.responses import Response

from sonolube.errors import InvalidInput
from sonolube.tasks.faults import unexpected

JSON: Final = "application/json"
"""Kind of content."""

_LARGEST_REQUEST: Final = 4 * 2**20  # bytes


async def refused(request: Request, failure: Exception) -> Response:
    """Refusal as JSON."""
    del request
    text = str(failure)
    return json_response({"text": text, "faults": [{"key": getattr(failure, "key", ""), "text": text}]}, status=422)


async def faulty(request: Request, failure: Exception) -> Response:
    """Fault of the program as JSON; the server prints its traceback."""
    text = str(unexpected(failure, request.url.path, {}))
    return json_response({"text": text, "faults": [{"key": "", "text": text}]}, status=500)


async def content_of(request: Request) -> dict[str, Any]:
    """Object of a request as JSON."""
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > _LARGEST_REQUEST:
            raise InvalidInput("the request is larger than 4 MiB; upload files instead")
    try:
        content = json.loads(body or b"{}", parse_constant=_refuse_constant)
    except (ValueError, RecursionError):
        raise InvalidInput("the request is no JSON") from None
    if not isinstance(content, dict):
        raise InvalidInput("the request is no object of JSON")
    return content


def _refuse_constant(name: str) -> None:
    """Refuse constants that JSON lacks."""
    raise ValueError(name)


def json_response(content: Mapping[str, Any], *, status: int = 200) -> Response:
    """Answer as JSON."""
    body = json.dumps(content).encode()
    return Response(body, status_code=status, media_type=JSON, headers={"cache-control": "no-store"})
