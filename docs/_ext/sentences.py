"""Sentences of the program that stand in running text of the pages."""

import runpy
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "examples" / "gallery" / "friction_and_wear" / "prediction.py"


def first_prediction() -> str:
    """What is predicted of the rig of the first picture, in bold."""
    answer = runpy.run_path(str(SCRIPT), run_name="gallery")["answer"]
    outcome, *_ = answer.object()["statement"][0].split(". ")
    return f"**{outcome}.**"
