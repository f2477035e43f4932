"""Text of users and of their files is shown as text: in files, in figures, on pages and on the terminal."""

import re
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, strategies as st
from tests.cli.terminal import without_progress

from sonolube.errors import InvalidInput
from sonolube.figure import render_figure
from sonolube.report.page import Page, rendered_files
from sonolube.rig import read_rig
from sonolube.text.plain_text import active_character, printable
from sonolube.text.toml_text import require_plain_content, toml_content

HOSTILE = "$x_{$ \x1b[2J \x00 \u202e \udcff <b> & {{ 7 }} 漢字"
SHOWN = r"$x_{$ \x1b[2J \x00 \u202e \udcff <b> & {{ 7 }} 漢字"


def test_characters_that_act_are_shown_as_escapes() -> None:
    assert printable(HOSTILE) == SHOWN
    assert active_character("a\x1bb") == "U+001B"
    assert active_character("µ, ° and\ttabs\n") is None


@given(st.text(alphabet=st.characters(), max_size=50))
def test_printable_text_can_be_encoded_and_has_nothing_left_to_escape(text: str) -> None:
    shown = printable(text)
    assert shown.encode().decode() == shown
    assert printable(shown) == shown


@pytest.mark.parametrize("form", ["png", "svg", "pdf"])
def test_a_figure_draws_hostile_titles_labels_legends_and_names_at_ticks(form: str) -> None:
    from matplotlib.figure import Figure

    figure = Figure()
    figure.suptitle(HOSTILE)
    axes = figure.add_subplot()
    axes.loglog([1, 10], [1, 10], label=HOSTILE)
    axes.set(title=HOSTILE, xlabel=HOSTILE, ylabel="$\\frac{1}{$")
    axes.set_xticks([1, 10], [HOSTILE, "$y_{$"])
    axes.text(1, 1, HOSTILE)
    axes.legend(title=HOSTILE)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        content = render_figure(figure, form)
    if form == "svg":
        text = content.decode()
        assert not re.search("[\x00-\x08\x0b-\x1f\u202e]", text)
        assert r"$x_{$ \x1b[2J" in text


def test_numbers_on_logarithmic_axes_stay_powers_of_ten() -> None:
    from matplotlib.figure import Figure

    figure = Figure()
    figure.add_subplot().loglog([1, 1e6], [1, 1e6])
    assert not re.search(r">\s*\$", render_figure(figure, "svg").decode())


def test_a_page_shows_hostile_text_as_it_is_written() -> None:
    page = Page(name="page", title=HOSTILE, settings=[(HOSTILE, HOSTILE)], facts=[])
    text = str(rendered_files({}, page=page, notes=[HOSTILE])["page.html"])
    assert "&lt;b&gt; &amp; {{ 7 }} 漢字" in text
    assert "<b>" not in text
    assert printable(text) == text
    assert text.encode()


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("a = " + "9" * 5000, "an integer of too many digits"),
        (".".join("a" * 20_000) + " = 1", "a key of more than 32 parts"),
        ("[" + " . ".join(["'a'"] * 20_000) + "]", "a key of more than 32 parts"),
        ("a = " + "[" * 5000 + "]" * 5000, "nested too deeply"),
        ("a = " + "[" * 100 + "]" * 100, "a: nested too deeply"),
        ("a = " + "{b = " * 100 + "1" + "}" * 100, "nested too deeply"),
        ('title = "\\u0000"', "title: holds the control character U+0000; leave it out"),
        ('a.b = ["\\u001b[2J"]', "a.b: holds the control character U+001B; leave it out"),
        ('"\\u202e" = 1', "holds the control character U+202E; leave it out"),
    ],
    ids=range(9),
)
def test_toml_without_end_or_with_control_characters_is_refused(text: str, line: str) -> None:
    with pytest.raises(InvalidInput, match=re.escape(line)):
        toml_content(text)


def test_usual_toml_is_read_as_ever() -> None:
    samples = ", ".join(["0.5"] * 5000)
    content = toml_content(f'title = """two\nlines, µ and 漢字"""\na.b.c = [{samples}]\n[x."y.z"]\nw = 1e9\n# a.b.c\n')
    assert content["title"] == "two\nlines, µ and 漢字"
    assert len(content["a"]["b"]["c"]) == 5000
    require_plain_content(content)


def test_no_toml_takes_long_to_refuse() -> None:
    code = (
        "from sonolube.errors import InvalidInput\nfrom sonolube.text.toml_text import toml_content\n"
        "for text in ('.'.join('a' * 500_000), 'a' * 10**6, '\"' * 10**6, 'a ' * 500_000, '[' * 10**6, '9' * 10**6,\n"
        "             'a=[' + '1.0,' * 200_000 + ']', 'a-' * 500_000, \"'.'\" * 300_000):\n"
        "    try: toml_content(text)\n    except InvalidInput: pass\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=300)


@pytest.fixture
def rig(tmp_path: Path) -> Callable[[str], Path]:
    """Tribometer's file with a title, in a folder and under a name that are no UTF-8."""
    text = (Path(__file__).parents[1] / "examples" / "rigs" / "tribometer.toml").read_text(encoding="utf-8")

    def write(title: str) -> Path:
        path = tmp_path / "\udcff\x1b[31m" / "\udcfe<b>$x_{$.toml"
        path.parent.mkdir(exist_ok=True)
        path.write_text(re.sub("^title = .*$", lambda _: f'title = "{title}"', text, count=1, flags=re.MULTILINE))
        return path

    return write


def run(*arguments: object) -> subprocess.CompletedProcess[bytes]:
    """Program in a process of its own, whose output is bytes."""
    words = [str(word).encode(errors="surrogateescape") for word in arguments]
    return subprocess.run([Path(sys.executable).parent / "sonolube", *words], capture_output=True, check=False)


@pytest.mark.parametrize("command", [("friction",), ("sweep", "--of", "load", "--points", "2")])
@pytest.mark.parametrize("form", [(), ("--json",)])
def test_hostile_names_and_titles_pass_through_a_command(
    command: tuple[str, ...], form: tuple[str, ...], rig: Callable[[str], Path], tmp_path: Path
) -> None:
    path = rig("$x_{$ <b>[/]</b> 漢字")
    out = () if command == ("friction",) else ("--out", tmp_path / "\udcfd\x1b[2J")
    ran = run(command[0], path, *command[1:], *form, *out)
    assert ran.returncode == 0
    told = ran.stderr.decode()
    assert without_progress(told) == ""
    assert printable(told) == told
    shown = ran.stdout.decode()
    assert printable(shown) == shown
    assert "$x_{$ <b>[/]</b>" in shown or "\\u6f22" in shown


def test_a_file_that_is_missing_is_named_without_its_control_characters(tmp_path: Path) -> None:
    ran = run("friction", tmp_path / "\udcff\x1b[31m.toml")
    assert ran.returncode == 2
    assert rb"\udcff\x1b[31m.toml: no such file" in ran.stderr


@pytest.mark.parametrize(
    "change", ["title=\x1b[2J", "title=\udcff", f"{'.'.join('a' * 5000)}=1", "sliding.sliding_speed=1\x00"]
)
def test_a_change_is_refused_as_the_file_would_be(change: str, rig: Callable[[str], Path]) -> None:
    from sonolube.rig import read_rig

    with pytest.raises(InvalidInput) as refusal:
        read_rig(rig("x"), changes=[change])
    assert "\n" not in str(refusal.value)


def test_a_title_of_many_lines_is_refused_by_its_length(tmp_path: Path) -> None:
    rig = tmp_path / "rig.toml"
    text = (Path(__file__).parents[1] / "examples" / "rigs" / "tribometer.toml").read_text(encoding="utf-8")
    rig.write_text(text.replace("Modified pin-on-disc", "x" * 1500), encoding="utf-8")
    with pytest.raises(InvalidInput, match="title") as refusal:
        read_rig(rig)
    assert len(str(refusal.value)) < 400
