"""Gallery of example rigs: a small picture of each, its title, and its answer in a sentence, as they are shipped.

After a change of a prediction or of the examples, `python -m sonolube.browser.example_pictures` draws them anew.
"""

import json
import math
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

from sonolube.browser.requests import Places
from sonolube.example_files import example_files
from sonolube.storage.files import write_atomically

FOLDER: Final = Path(str(files("sonolube.browser")), "static", "examples")
"""Folder of the pictures, and of `examples.json`, their titles and sentences in order."""

_WIDTH, _HEIGHT, _MARGIN = 240, 112, 8
_LARGEST: Final = 1.05  # friction ratio at the upper edge
_BLUE, _GREY = "#2f86bd", "#7d8790"  # seen on light and dark pages
_BANDS: Final = (0.18, 0.25, 0.35)  # opacities of the intervals of 95, 80 and 50 %
_POINTS: Final = 25
_DECADE: Final = 6.0  # over which the curve of a model runs below and above the amplitude of its rig

Floats = Sequence[float]


def example_entry(name: str) -> dict[str, str]:
    """Name, title, sentence and picture (SVG) of an example rig."""
    title = example_files()[name].title
    reply = _asked("predict", {"rig": {"name": name, "changes": {}}})
    if "answer" in reply:
        text = reply["answer"]["statement"][0].partition(". ")[0].rpartition(": ")[2]
        text = f"{text[:1].upper()}{text[1:]}"
        panel = reply["charts"][0]["chart"]["panels"][0]
        return {"name": name, "title": title, "text": f"{text}.", "picture": _of_panel(panel)}
    answer = _asked("friction", {"rig": {"name": name, "changes": {}}})["answer"]
    change = 100 * answer["friction_reduction"]["value"]
    text = f"By its model alone, friction falls by {change:.0f} %."
    return {"name": name, "title": title, "text": text, "picture": _of_model(name, answer)}


def main() -> None:
    """Write all pictures, and the list of them."""
    entries = [example_entry(name) for name, each in example_files().items() if each.is_rig]
    for entry in entries:
        write_atomically(FOLDER / f"{entry['name']}.svg", entry.pop("picture"))
    write_atomically(FOLDER / "examples.json", json.dumps(entries, ensure_ascii=False, indent=1) + "\n")


def _asked(task: str, arguments: dict[str, Any]) -> dict[str, Any]:
    """Answer of a task as pages get it, or its refusal."""
    from sonolube.browser.worker import reply

    found: dict[str, Any] = json.loads(reply("task", {"task": task, "arguments": arguments}, Places(rigs={}))[1])
    return found


def _of_panel(panel: dict[str, Any]) -> str:
    """Picture of a panel of friction over amplitude: its intervals, median and operating point."""
    x = panel["x"]
    parts = {kind: [part for part in panel["parts"] if part["kind"] == kind] for kind in ("band", "line", "rule")}
    scale = _Scale(x["lowest"], x["highest"])
    shapes = [
        f'<path d="{scale.band(part["x"], part["low"], part["high"])}" fill="{_BLUE}" fill-opacity="{opacity}"/>'
        for part, opacity in zip(parts["band"], _BANDS, strict=False)
    ]
    line = parts["line"][0]
    at = parts["rule"][0]["value"] if parts["rule"] else math.sqrt(x["lowest"] * x["highest"])
    return _picture([*shapes, *scale.curve(line["x"], line["y"], at)])


def _of_model(name: str, answer: dict[str, Any]) -> str:
    """Picture of friction over amplitude by the model of a rig, which has no interval."""
    middle = answer["vibration_amplitude"]["value"]
    amplitudes = [middle * _DECADE ** (2 * step / (_POINTS - 1) - 1) for step in range(_POINTS)]
    ratios = []
    for amplitude in amplitudes:
        changes = {"vibration.vibration_amplitude": f"{1e6 * amplitude:.6g} um"}
        found = _asked("friction", {"rig": {"name": name, "changes": changes}})
        ratios.append(found["answer"]["friction_ratio"]["value"])
    return _picture(_Scale(amplitudes[0], amplitudes[-1]).curve(amplitudes, ratios, middle))


class _Scale:
    """Places of amplitudes (by decades) and of friction ratios within the picture."""

    def __init__(self, lowest: float, highest: float) -> None:
        self._lowest, self._decades = lowest, math.log(highest / lowest)

    def x(self, value: float) -> float:
        return _MARGIN + (_WIDTH - 2 * _MARGIN) * math.log(value / self._lowest) / self._decades

    def y(self, ratio: float) -> float:
        return _HEIGHT - _MARGIN - (_HEIGHT - 2 * _MARGIN) * min(max(ratio, 0.0), _LARGEST) / _LARGEST

    def points(self, x: Floats, y: Floats) -> str:
        return " ".join(f"{self.x(a):.1f} {self.y(b):.1f}" for a, b in zip(x, y, strict=True))

    def band(self, x: Floats, low: Floats, high: Floats) -> str:
        return f"M{self.points(x, high)} {self.points(x[::-1], low[::-1])}z"

    def curve(self, x: Floats, y: Floats, at: float) -> list[str]:
        """Line with the operating point on it."""
        place = min(range(len(x)), key=lambda each: abs(math.log(x[each] / at)))
        left, top = self.x(at), self.y(y[place])
        return [
            f'<path d="M{left:.1f} {_MARGIN}V{_HEIGHT - _MARGIN}" stroke="{_GREY}" stroke-dasharray="2 3"/>',
            f'<path d="M{self.points(x, y)}" fill="none" stroke="{_BLUE}" stroke-width="2.5"/>',
            f'<circle cx="{left:.1f}" cy="{top:.1f}" r="4.5" fill="{_BLUE}" stroke="#fff" stroke-width="1.5"/>',
        ]


def _picture(shapes: Sequence[str]) -> str:
    """Picture with its axes."""
    axes = (
        f'<path d="M{_MARGIN} {_MARGIN}V{_HEIGHT - _MARGIN}H{_WIDTH - _MARGIN}" fill="none" stroke="{_GREY}"'
        ' stroke-opacity=".6"/>'
    )
    content = "".join([axes, *shapes])
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}">{content}</svg>\n'


if __name__ == "__main__":
    main()
