"""Docstrings of tasks and commands: read from the source, and without what only Python shows."""

import ast
from importlib.resources import files
from typing import Final

_EXAMPLES: Final = "\n\nExamples\n--------\n"


def docstring(package: str, where: str) -> str:
    """Docstring, without examples, of a function such as "predict.wear:wear"; its module is not imported."""
    module, _, name = f"{package}.{where}".strip(".").partition(":")
    root, _, inner = module.partition(".")
    source = files(root).joinpath(f"{inner.replace('.', '/')}.py").read_text(encoding="utf-8")
    nodes = (node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef) and node.name == name)
    return split_examples(ast.get_docstring(next(nodes)) or "")[0]


def split_examples(text: str) -> tuple[str, str]:
    """Docstring without its section Examples, which has `>>>` of Python, and that section."""
    before, heading, examples = text.partition(_EXAMPLES)
    return before, f"{heading}{examples}".strip()
