"""Uploads: names and paths of requests, limits of one file and of all, and files of the pages as they are sent."""

import asyncio
import gzip
import os
from collections.abc import AsyncIterator, Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from pytest import MonkeyPatch, raises
from starlette.applications import Starlette
from starlette.routing import Route
from tests.browser.asgi import Client

from sonolube.browser import static_files, uploads as module
from sonolube.browser.messages import content_of, json_response, refused
from sonolube.browser.requests import Places
from sonolube.browser.static_files import static_file
from sonolube.browser.uploads import Uploads, companion, named_uploads, uploaded
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.tasks.files import NamedBytes, file_path


@pytest.fixture
def uploads() -> Iterator[Uploads]:
    found = Uploads(largest=100)
    yield found
    found.end()
    assert not found.folder.exists()


async def parts(*contents: bytes) -> AsyncIterator[bytes]:
    for each in contents:
        yield each


def kept(uploads: Uploads, *contents: bytes, length: int | None = None) -> str:
    return asyncio.run(uploads.keep(parts(*contents), length=length))


def test_a_file_up_to_the_limit_is_kept_under_a_name_of_ours(uploads: Uploads) -> None:
    name = kept(uploads, b"a" * 60, b"b" * 40, length=100)
    assert (uploads.folder / name).read_bytes() == b"a" * 60 + b"b" * 40
    assert len(name) == 32
    assert name.isalnum()


@pytest.mark.parametrize(("contents", "length"), [((b"a" * 60, b"b" * 41), None), ((), 101), ((b"a" * 101,), 3)])
def test_a_larger_file_is_refused_by_its_announced_or_its_real_size_and_leaves_nothing(
    contents: tuple[bytes, ...], length: int | None, uploads: Uploads
) -> None:
    with raises(InvalidInput, match="that a page may upload"):
        kept(uploads, *contents, length=length)
    assert list(uploads.folder.iterdir()) == []


def test_the_limit_is_said_in_mebibytes() -> None:
    own = Uploads()
    try:
        with raises(InvalidInput, match=r"^300 MiB are more than the 256 MiB that a page may upload$"):
            asyncio.run(own.keep(parts(), length=300 * 2**20))
    finally:
        own.end()


def test_the_oldest_files_go_with_what_is_kept_beside_them_beyond_the_limit_of_all(
    uploads: Uploads, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_MOST", 200)
    names = []
    for place in range(3):
        names.append(kept(uploads, b"x" * 60))
        os.utime(uploads.folder / names[-1], (place, place))
    beside = uploads.folder / f"{names[0]}.abc.json"
    beside.write_bytes(b"x" * 20)
    assert {path.name for path in uploads.folder.iterdir()} == {*names, beside.name}  # 200 bytes are not too many
    names.append(kept(uploads, b"x"))
    assert {path.name for path in uploads.folder.iterdir()} == set(names[1:])
    kept(uploads, b"x" * 100)
    assert names[2] in {path.name for path in uploads.folder.iterdir()}  # the second alone had to go
    assert names[1] not in {path.name for path in uploads.folder.iterdir()}


@pytest.mark.parametrize(
    ("name", "found"),
    [("a.csv", "a.csv"), ("C:\\data\\a.csv", "a.csv"), ("../.a", "a"), ("...", "file"), ("/", "file")],
)
def test_an_upload_has_its_name_without_folders_and_dots(name: str, found: str, tmp_path: Path) -> None:
    (tmp_path / "00ff").write_bytes(b"")
    places = Places(rigs={}, uploads=str(tmp_path))
    assert uploaded({"name": name, "upload": "00ff"}, places) == (found, tmp_path / "00ff")
    with raises(InvalidInput, match="no longer here") as refusal:
        uploaded({"name": name, "upload": "00ff"}, Places(rigs={}))
    assert refusal.value.key == "file"


def test_what_is_kept_beside_an_upload_has_its_name_before(tmp_path: Path) -> None:
    assert companion(tmp_path / "00ff", "abc.json") == tmp_path / "00ff.abc.json"


def test_refusals_of_uploads_have_their_names_alone_and_their_key() -> None:

    def refuse() -> None:
        with named_uploads():
            raise InvalidInput(f"{file_path(NamedBytes('own.csv', b''))}: is empty", key="file")

    with raises(InvalidInput, match=r"^own\.csv: is empty$") as refusal:
        refuse()
    assert refusal.value.key == "file"


@pytest.fixture
def client() -> Client:
    async def echo(request: Any) -> Any:
        return json_response(await content_of(request), status=201)

    routes = [Route("/echo", echo, methods=["POST"]), Route("/static/{name:path}", static_file)]
    return Client(Starlette(routes=routes, exception_handlers={SonolubeError: refused}))


def test_the_object_of_a_request_is_read_up_to_four_mebibytes(client: Client) -> None:
    answer = client.post("/echo", {"a": 1})
    assert (answer.status_code, answer.json(), answer.headers["cache-control"]) == (201, {"a": 1}, "no-store")
    assert client.post("/echo", b"").json() == {}
    whole = b'{"a": "' + b"x" * (4 * 2**20 - 9) + b'"}'
    assert len(whole) == 4 * 2**20
    assert client.post("/echo", whole).status_code == 201
    for body, words in (
        (whole + b" ", "larger than 4 MiB"), (b"[1]", "no object of JSON"), (b"{", "is no JSON"),
        (b'{"a": NaN}', "is no JSON"), (b"[" * 100_000, "is no JSON"),
    ):  # fmt: skip
        refusal = client.post("/echo", body)
        assert (refusal.status_code, words in refusal.json()["text"]) == (422, True)
        assert refusal.json()["faults"] == [{"key": "", "text": refusal.json()["text"]}]


@pytest.mark.parametrize(
    ("name", "kind"),
    [("app.css", "text/css; charset=utf-8"), ("icon.svg", "image/svg+xml"), ("first-page.json", "application/json"),
     ("vendor/README.md", "text/plain; charset=utf-8")],
)  # fmt: skip
def test_a_file_of_the_pages_is_sent_with_its_kind_and_tag_and_not_again(name: str, kind: str, client: Client) -> None:
    content = (static_files._FOLDER / name).read_bytes()
    plain = client.get(f"/static/{name}")
    assert (plain.content, plain.headers["content-type"]) == (content, kind)
    assert plain.headers["etag"] == f'"{sha256(content).hexdigest()[:16]}"'
    assert (plain.headers["cache-control"], plain.headers["vary"]) == ("no-cache", "Accept-Encoding")
    assert "content-encoding" not in plain.headers
    packed = client.get(f"/static/{name}", accept_encoding="br, gzip")
    assert (gzip.decompress(packed.content), packed.headers["content-encoding"]) == (content, "gzip")
    assert len(packed.content) < len(content)
    again = client.get(f"/static/{name}", if_none_match=plain.headers["etag"])
    assert (again.status_code, again.content) == (304, b"")
    assert client.get("/static/none.css").status_code == 404
