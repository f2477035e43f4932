"""Rig of an answer as text and JSON: its operating point and its friction model."""

from typing import TYPE_CHECKING

from sonolube.text.units import format_si

if TYPE_CHECKING:
    from sonolube.rig import Rig


def friction_model_text(rig: "Rig") -> str:
    """Friction model of a rig as text, such as "friction model kinematic"."""
    return f"friction model {rig.friction_model.name}"


def operating_point(rig: "Rig") -> str:
    """Title, load, speed and friction model of a rig as one line."""
    load, speed = format_si(rig.normal_load, "N"), format_si(rig.sliding_speed, "m/s")
    return f"{rig.title}, {load}, {speed}, {friction_model_text(rig)}"


def rig_settings(rig: "Rig") -> list[tuple[str, str]]:
    """Rig of a page: title, file, source, load, speed, friction without vibration, friction model and amplitude."""
    return [
        ("rig", rig.title if rig.file is None else f"{rig.title} ({rig.file.name})"),
        *([("source of its numbers", rig.source)] if rig.source else []),
        ("load and speed", f"{format_si(rig.normal_load, 'N')}, {format_si(rig.sliding_speed, 'm/s')}"),
        ("without vibration", f"coefficient of friction {rig.friction_coefficient:.3g}"),
        ("friction model", rig.friction_model.name),
        *amplitude_rows(rig),
    ]


def amplitude_object(rig: "Rig") -> dict[str, str]:
    """Source of a rig's amplitude and the same in words, for JSON; empty where the rig has none."""
    from sonolube.rig import amplitude_labels

    return amplitude_labels(rig)


def amplitude_rows(rig: "Rig") -> list[tuple[str, str]]:
    """The same as rows of text."""
    return [("amplitude", text) for name, text in amplitude_object(rig).items() if name == "amplitude_origin"]
