"""Names that code of earlier versions imports, each refused in one line with its place of today."""

import sys

_MODELS = ("surfaces", "contact", "friction", "wear", "thermal", "actuator", "dynamics", "fem")
_FACTS = ("materials", "published", "metrics", "protocol")
_TEXT = ("units", "unit_grammar", "toml_text")
_STORAGE = ("files", "growing_files", "interruption")
_EXECUTION = ("threads", "compilation")
_ROOMS = {
    **{room: f"models.{room}" for room in _MODELS},
    **{room: f"facts.{room}" for room in _FACTS},
    **{"reproduce": "reproduction", "lab": "laboratory", "workbench": "tasks"},
    **{name: f"text.{name}" for name in _TEXT},
    **{name: f"storage.{name}" for name in _STORAGE},
    **{name: f"execution.{name}" for name in _EXECUTION},
    **{"common_units": "text.units", "printable_text": "text.plain_text", "text_layout": "text.plain_text"},
    **dict.fromkeys(("targets", "input_files"), "storage.user_files"),
}
_FUNCTIONS = {"new_rig": "new", "fit_runs": "fit"}


def former_name(name: str) -> str | None:
    """Sentence about a name of `sonolube` of earlier versions; None for others."""
    if name in _FUNCTIONS:
        return f"sonolube.{name} is now sonolube.{_FUNCTIONS[name]}"
    if name == "design":
        return "sonolube.design is a room: import what you need from it, or call sonolube.sweep and the other tasks"
    room, dot, rest = name.partition(".")
    return f"sonolube.{name} is now sonolube.{_ROOMS[room]}{dot}{rest}" if room in _ROOMS else None


def moved_module(name: str) -> str:
    """Where the contents of a former module are whose name a task or a group of tasks has now; empty for others."""
    return f"; the module sonolube.{name} is now sonolube.{_ROOMS[name]}" if name in _ROOMS else ""


class _FormerPlaces:
    """Finder that comes last and refuses modules of former rooms."""

    def find_spec(self, fullname: str, path: object = None, target: object = None) -> None:
        """Raise ModuleNotFoundError for a module of a former room."""
        package, _, name = fullname.partition(".")
        if package == "sonolube" and name.partition(".")[0] in _ROOMS:
            raise ModuleNotFoundError(former_name(name), name=f"sonolube.{_ROOMS[name.partition('.')[0]]}")


def refuse_former_modules() -> None:
    """Refuse imports of former rooms in one line."""
    if not any(isinstance(finder, _FormerPlaces) for finder in sys.meta_path):
        sys.meta_path.append(_FormerPlaces())
