"""Sphinx extension for the gallery and the notebooks, made from the scripts of `examples` when the pages are built.

On a line of its own, `<!-- gallery: GROUP -->` is replaced by the figures of a group with captions and scripts,
`<!-- picture: GROUP/NAME -->` by one figure, and `<!-- notebook: NAME -->` by a notebook with its output.
"""

import ast
import os
import re
import struct
from pathlib import Path

from notebooks import markdown_of
from pictures import ROOT, image, picture_of
from sphinx.application import Sphinx

EXAMPLES = ROOT / "examples"
_WIDE = 900  # pixels, above which a figure has the width of the page


def gallery(group: str, page: Path) -> str:
    """Return the figures of a group as Markdown."""
    scripts = sorted((EXAMPLES / "gallery" / group).glob("*.py"))
    return "\n\n".join(["::::{container} gallery", *(_item(script, page) for script in scripts), "::::"])


def picture(name: str, page: Path) -> str:
    """Return one figure of the gallery as Markdown."""
    script = EXAMPLES / "gallery" / f"{name}.py"
    return _image(title_and_caption(script)[0], picture_of(script), page)


def notebook(name: str, page: Path) -> str:
    """Return a notebook as Markdown, with links to its files."""
    script = EXAMPLES / "notebooks" / f"{name}.py"
    text, folder = markdown_of(script)
    place = os.path.relpath(folder, page.parent)
    source = os.path.relpath(script, page.parent)
    links = f"Take it: {{download}}`Jupyter notebook <{place}/{name}.ipynb>`, {{download}}`script <{source}>`."
    title, _, rest = text.replace("{folder}", place).partition("\n")
    return f"{title}\n\n{links} Run it in `examples/notebooks` of the repository.\n{rest}"


def title_and_caption(script: Path) -> tuple[str, str]:
    """Return the first line of a script's docstring, and the rest of it."""
    title, _, caption = (ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or "").partition("\n")
    return title.strip(), " ".join(caption.split())


def _item(script: Path, page: Path) -> str:
    """Return a figure with its caption and its script behind a fold."""
    title, caption = title_and_caption(script)
    shown = picture_of(script)
    width = struct.unpack(">I", shown.read_bytes()[16:20])[0]
    code = script.read_text(encoding="utf-8").rstrip()
    return f""":::{{container}} {"gallery-item wide" if width > _WIDE else "gallery-item"}
{_image(title, shown, page)}

**{title}.** {caption}

<details><summary>{script.name}</summary>

```python
{code}
```

</details>
:::"""


def _image(title: str, shown: Path, page: Path) -> str:
    return image(title, os.path.relpath(shown, page.parent))


MADE = {"gallery": gallery, "picture": picture, "notebook": notebook}


def fill(app: Sphinx, docname: str, source: list[str]) -> None:
    """Replace the comments that name figures and notebooks, before a page is parsed."""
    page = Path(app.env.doc2path(docname))
    filled = re.sub(
        r"^<!-- (gallery|picture|notebook): (\S+) -->$",
        lambda match: MADE[match[1]](match[2], page),
        source[0],
        flags=re.MULTILINE,
    )
    if filled != source[0]:
        app.env.note_reread()
    source[0] = filled


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("source-read", fill)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
