"""Tables of runs as laboratories write them, written by code, each with its right value.

All hold the same four runs: 5 N, 200, 200, 200 and 100 mm/s, amplitudes of 1, 2, 3 and 2 um, friction of 1.72, 1.30,
0.98 and 1.01 N with vibration and of 2.10, 2.10, 2.10 and 2.14 N without. A coefficient of friction is the force over
5 N, so that the ratios are the same.
"""

import io
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal
from xml.sax.saxutils import escape

FORCES = ("1.72", "1.30", "0.98", "1.01")
WITHOUT = ("2.10", "2.10", "2.10", "2.14")
CELLS: Mapping[str, Sequence[str]] = {
    "R": ("1", "2", "3", "4"),
    "L": ("5.0", "5.0", "5.0", "5.0"),
    "V": ("200", "200", "200", "100"),
    "A": ("1.0", "2.0", "3.0", "2.0"),
    "D": ("2.0", "4.0", "6.0", "4.0"),  # the amplitude peak to peak
    "U": ("12.5", "25.0", "37.5", "25.0"),  # the voltage peak to peak
    "F": FORCES,
    "G": WITHOUT,
    "M": ("0.344", "0.260", "0.196", "0.202"),
    "N": ("0.420", "0.420", "0.420", "0.428"),
    "": ("", "", "", ""),
}
RATIOS = (1.72 / 2.10, 1.30 / 2.10, 0.98 / 2.10, 1.01 / 2.14)
LOAD = {"normal_load": (5.0,) * 4}
SPEED = {"sliding_speed": (0.2, 0.2, 0.2, 0.1)}
AMPLITUDE = {"vibration_amplitude": (1e-6, 2e-6, 3e-6, 2e-6)}
VOLTAGE = {"voltage_peak_to_peak": (12.5, 25.0, 37.5, 25.0)}
RATIO = {"friction_ratio": RATIOS}
RIGHT = LOAD | SPEED | AMPLITUDE | RATIO

Grid = list[list[str]]


@dataclass(frozen=True, kw_only=True)
class LaboratoryTable:
    """One table.

    `right` has the values by quantity in SI, `friction_ratio` among them. Where the table alone does not tell them,
    `statements` are those of columns that `sonolube mapping` is given, and `decimal_sign` the decimal sign.
    """

    kind: str
    content: bytes
    right: Mapping[str, Sequence[float]]
    suffix: str = ".csv"
    statements: Mapping[str, str] = field(default_factory=dict)
    decimal_sign: Literal[".", ","] | None = None

    @property
    def is_asked(self) -> bool:
        """Whether a reader has to ask."""
        return bool(self.statements) or self.decimal_sign is not None


def grid(heads: Sequence[str], keys: str) -> Grid:
    """Headings and the cells of the four runs, a letter of `CELLS` for each column; a dash for an empty one."""
    columns = [CELLS["" if key == "-" else key] for key in keys]
    return [list(heads), *(list(row) for row in zip(*columns, strict=True))]


def text(rows: Sequence[Sequence[str]], separator: str = ";", *, comma: bool = False, end: str = "\n") -> str:
    """Rows as lines of cells; with decimal commas in cells that begin with a digit."""
    lines = [separator.join(_with_comma(cell) if comma else cell for cell in row) for row in rows]
    return end.join(lines) + end


def _with_comma(cell: str) -> str:
    return cell.replace(".", ",") if cell[:1].isdigit() else cell


def aligned(rows: Grid, *, comma: bool = False) -> str:
    """Rows in columns of equal width, at least two blanks between them."""
    cells = [[_with_comma(cell) if comma else cell for cell in row] for row in rows]
    widths = [max(map(len, column)) + 2 for column in zip(*cells, strict=True)]
    return "".join("".join(map(str.ljust, row, widths)).rstrip() + "\n" for row in cells)


ENGLISH = ["Run", "Load [N]", "Speed [mm/s]", "Amplitude [um]", "Friction force [N]", "Friction without vibration [N]"]
GERMAN = [
    "Versuch",
    "Normalkraft [N]",
    "Geschwindigkeit [mm/s]",
    "Amplitude [µm]",
    "Reibkraft [N]",
    "Reibkraft ohne Ultraschall [N]",
]
FULL = grid(ENGLISH, "RLVAFG")
VOLL = grid(GERMAN, "RLVAFG")


def _table(kind: str, content: str, right: Mapping[str, Sequence[float]] = RIGHT, **others: object) -> LaboratoryTable:
    encoding = str(others.pop("encoding", "utf-8"))
    return LaboratoryTable(kind=kind, content=content.encode(encoding), right=right, **others)  # type: ignore[arg-type]


def _headings() -> list[LaboratoryTable]:
    kind = "plain headings"
    english = [
        grid(["Load [N]", "Speed [mm/s]", "Amplitude [um]", "COF on", "COF off"], "LVAMN"),
        grid(["FN (N)", "v (mm/s)", "a (µm)", "mu", "mu_0"], "LVAMN"),
        grid(
            ["Normal force / N", "sliding speed / mm/s", "Amplitude zero-to-peak / um", "F on / N", "F off / N"],
            "LVAFG",
        ),
        grid(["Load [N]", "v [mm/s]", "Amplitude pp [um]", "COF with US", "COF without US"], "LVDMN"),
    ]
    german = [
        grid(["Last [N]", "v [mm/s]", "Schwingamplitude [µm]", "Reibkraft [N]", "Reibkraft ohne [N]"], "LVAFG"),
        grid(
            ["Normalkraft in N", "Geschwindigkeit in mm/s", "Amplitude in µm", "Reibzahl mit US", "Reibzahl ohne US"],
            "LVAMN",
        ),
        grid(
            ["FN [N]", "v [mm/s]", "Amplitude Spitze-Spitze [µm]", "µ mit Ultraschall", "µ ohne Ultraschall"], "LVDMN"
        ),
    ]
    voltages = [
        grid(["Load [N]", "Speed [mm/s]", "Vpp", "Friction on [N]", "Friction off [N]"], "LVUFG"),
        grid(["Load [N]", "Speed [mm/s]", "[Vpp]", "COF on", "COF off"], "LVUMN"),
        grid(["Last [N]", "Geschwindigkeit [mm/s]", "Spannung [Vpp]", "µ mit", "µ ohne"], "LVUMN"),
    ]
    by_voltage = LOAD | SPEED | VOLTAGE | RATIO
    return [
        *(_table(kind, text(rows, ",")) for rows in english),
        *(_table(kind, text(rows, comma=True)) for rows in german),
        *(_table("voltages", text(rows), by_voltage) for rows in voltages),
    ]


def _ambiguous() -> list[LaboratoryTable]:
    kind = "headings of two meanings"
    width = grid(["Last [N]", "v [mm/s]", "Schwingweite [µm]", "COF on", "COF off"], "LVDMN")
    volts = grid(["Load [N]", "v [mm/s]", "voltage [V]", "COF on", "COF off"], "LVUMN")
    force = grid(["F [N]", "v [mm/s]", "Amplitude [um]", "COF on", "COF off"], "LVAMN")
    return [
        _table(kind, text(width), statements={"Schwingweite [µm]": "vibration_amplitude um pp"}),
        _table(
            kind, text(volts, ","), LOAD | SPEED | VOLTAGE | RATIO, statements={"voltage [V]": "voltage_peak_to_peak V"}
        ),
        _table(kind, text(force, ","), statements={"F [N]": "normal_load N"}),
    ]


def _units() -> list[LaboratoryTable]:
    heads, units = ["Load", "Speed", "Amplitude", "F on", "F off"], ["N", "mm/s", "um", "N", "N"]
    rows = grid(heads, "LVAFG")
    german = grid(["Versuch", "Last", "Geschwindigkeit", "Amplitude", "Reibzahl", "Reibzahl ohne"], "RLVAMN")
    row = "unit row"
    below = [
        _table(row, text([rows[0], units, *rows[1:]])),
        _table(row, text([rows[0], [f"[{unit}]" for unit in units], *rows[1:]], "\t")),
        _table(row, text([german[0], ["", "N", "mm/s", "µm", "-", "-"], *german[1:]], comma=True)),
    ]
    asked = dict(zip(heads, ("normal_load N", "sliding_speed mm/s", "vibration_amplitude um"), strict=False))
    forces = {"F on": "friction_force N", "F off": "intrinsic_friction_force N"}
    names = ["normal_load", "sliding_speed", "vibration_amplitude", "friction_force", "intrinsic_friction_force"]
    plain = {name: f"{name} {unit}" for name, unit in zip(names, units, strict=True)}
    gauge = {"Last": "normal_load N", "Geschwindigkeit": "sliding_speed mm/s", "Amplitude": "vibration_amplitude um"}
    none = "no units"
    return [
        *below,
        _table(none, text(rows), statements=asked | forces),
        _table(none, text(german, comma=True), statements=gauge),
        _table(none, text(grid(names, "LVAFG"), ","), statements=plain),
    ]


def _with_column(name: str, cells: Sequence[str], rows: Grid | None = None) -> Grid:
    base = grid(["Load [N]", "Speed [mm/s]", "Amplitude [um]"], "LVA") if rows is None else rows
    return [[*row, cell] for row, cell in zip(base, [name, *cells], strict=True)]


def _percent() -> list[LaboratoryTable]:
    kind = "percent"
    right = LOAD | SPEED | AMPLITUDE | {"friction_ratio": (0.82, 0.62, 0.47, 0.53)}
    half = LOAD | SPEED | AMPLITUDE | {"friction_ratio": (0.815, 0.615, 0.465, 0.525)}
    return [
        _table(kind, text(_with_column("Friction reduction", ["18 %", "38 %", "53 %", "47 %"]), ","), right),
        _table(kind, text(_with_column("Reibungsminderung [%]", ["18.5", "38.5", "53.5", "47.5"]), comma=True), half),
        _table(
            kind, text(_with_column("Reibungsminderung", ["18.5 %", "38.5%", "53.5 %", "47.5 %"]), comma=True), half
        ),
        _table(kind, text(_with_column("Friction ratio in %", ["82", "62", "47", "53"]), "\t"), right),
    ]


def _uncertain(mark: str, form: str = "{} {} {}") -> list[str]:
    return [form.format(cell, mark, "0.02") for cell in FORCES]


def _uncertainties() -> list[LaboratoryTable]:
    kind = "uncertainty in cells"
    base = grid(["Load [N]", "Speed [mm/s]", "Amplitude [um]", "F off [N]"], "LVAG")
    stated = RIGHT | {"friction_force_uncertainty": (0.02,) * 4}
    ratios = [f"{cell} ± 0.004" for cell in CELLS["M"]]
    cof = grid(["Last [N]", "v [mm/s]", "Amplitude [µm]", "Reibzahl ohne US"], "LVAN")
    return [
        _table(kind, text(_with_column("F on [N]", _uncertain("+-"), base), ","), stated),
        _table(kind, text(_with_column("F on [N]", _uncertain("±"), base), "\t"), stated),
        _table(kind, text(_with_column("F on [N]", [f"{cell}(2)" for cell in FORCES], base), ","), stated),
        _table(
            kind,
            text(_with_column("Reibzahl mit US", ratios, cof)).replace(".", ","),
            RIGHT | {"friction_coefficient_uncertainty": (0.004,) * 4},
        ),
    ]


def _signs() -> list[LaboratoryTable]:
    large = ["5,000.0", "5,000.0", "5,000.0", "5,000.0"]
    kilo = {"g": [cell.replace(",", "_").replace(".", ",").replace("_", ".") for cell in large]}
    swiss = [cell.replace(",", "'") for cell in large]
    narrow = [cell.replace(",", "\u202f").replace(".", ",") for cell in large]
    rest = grid(["Speed [mm/s]", "Amplitude [um]", "F on [N]", "F off [N]"], "VAFG")
    speeds, amplitudes = ["200.000", "200.000", "200.000", "100.000"], ["1.000", "2.000", "3.000", "2.000"]
    without = ["2.100", "2.100", "2.100", "2.140"]
    dots = [["Last [mN]", "v [µm/s]", "Amplitude [nm]", "Reibkraft [mN]", "Reibkraft ohne [mN]"]]
    dots += [
        list(row)
        for row in zip(["5.000"] * 4, speeds, amplitudes, ["1.720", "1.300", "1.080", "1.010"], without, strict=True)
    ]
    thousand = RIGHT | {"friction_ratio": (1.72 / 2.1, 1.3 / 2.1, 1.08 / 2.1, 1.01 / 2.14)}
    comma = "decimal comma"
    mark = "thousands"
    return [
        _table(comma, text(VOLL, comma=True)),
        _table(comma, text(VOLL, "\t", comma=True, end="\r\n"), suffix=".txt"),
        _table(comma, aligned(VOLL, comma=True), suffix=".txt"),
        _table(mark, text(_with_column("Load [mN]", [f'"{cell}"' for cell in large], rest), ",")),
        _table(mark, text(_with_column("Last [mN]", kilo["g"], [[_with_comma(each) for each in row] for row in rest]))),
        _table(mark, text(_with_column("Last [mN]", swiss, rest))),
        _table(mark, text(_with_column("Last [mN]", narrow, [[_with_comma(each) for each in row] for row in rest]))),
        _table(mark, text(dots), thousand, decimal_sign=","),
    ]


def _separators() -> list[LaboratoryTable]:
    kind = "separators"
    narrow = grid(["Load_N", "Speed_mm/s", "Amplitude_um", "COF_on", "COF_off"], "LVAMN")
    piped = "".join(f"| {' | '.join(row)} |\n" for row in [FULL[0], ["---"] * 6, *FULL[1:]])
    return [
        _table(kind, aligned(FULL), suffix=".txt"),
        _table(kind, text(narrow, " "), suffix=".dat"),
        _table(kind, piped, suffix=".md"),
        _table(kind, text(FULL, "|"), suffix=".txt"),
    ]


def _lines() -> list[LaboratoryTable]:
    rows, before = text(FULL, ","), "preamble"
    german = text(VOLL, comma=True)
    pairs = "Operator: A. Meier\nDate: 2026-03-12\nMaterial; steel on brass\n"
    sheet = "Prüfstand 3;;;;;\nDatum;12.03.2026;;;;\nBediener;Müller;;;;\n;;;;;\n"
    marked = "# Test 7, dry\n# pin 3\nsep=,\n"
    first, *body = rows.splitlines(keepends=True)
    comment = "comment rows"
    summary = "summary rows"
    again = "repeated header"
    mean = ",5.0,175,2.0,1.25,2.11\n"
    return [
        _table(before, pairs + rows),
        _table(before, sheet + german),
        _table(before, marked + rows),
        _table(before, "Friction tests of March, load 5 N, three speeds\n\n" + text(FULL, "\t"), suffix=".txt"),
        _table(comment, first + body[0] + "# pin cleaned\n" + "".join(body[1:])),
        _table(comment, first + body[0] + body[1] + "pause,,,,,\n" + "".join(body[2:])),
        _table(comment, rows + "\n* third run with squeal\n"),
        _table(summary, rows + f"Mean{mean}SD,0.0,50,0.8,0.36,0.02\n"),
        _table(summary, german + "\nMittelwert;5,0;175;2,0;1,25;2,11\n"),
        _table(summary, rows + f"Ø{mean}"),
        _table(again, first + "".join(body[:2]) + first + "".join(body[2:])),
        _table(again, first + "".join(body[:2]) + "\n\n" + first + "".join(body[2:])),
        _table(again, text([*VOLL[:3], *([VOLL[0]]), *VOLL[3:]], "\t", comma=True), suffix=".txt"),
    ]


def _merged() -> list[LaboratoryTable]:
    kind = "merged headings"
    body = FULL[1:]
    over = ["", "Settings", "", "", "Friction force [N]", ""]
    under = ["Run", "Load [N]", "Speed [mm/s]", "Amplitude [um]", "on", "off"]
    coefficient = ["", "", "", "", "Reibungszahl", ""]
    heads = ["Versuch", "Last [N]", "v [mm/s]", "Amplitude [µm]", "mit US", "ohne US"]
    names = ["Run", "Load", "Speed", "Amplitude", "Friction force", ""]
    states, units = ["", "", "", "", "on", "off"], ["", "N", "mm/s", "um", "N", "N"]
    return [
        _table(kind, text([over, under, *body], ",")),
        _table(kind, text([coefficient, heads, *grid(heads, "RLVAMN")[1:]], comma=True)),
        _table(kind, text([names, states, units, *body], "\t"), suffix=".txt"),
    ]


def _without_heads() -> list[LaboratoryTable]:
    kind = "no header"
    names = (
        "normal_load N",
        "sliding_speed mm/s",
        "vibration_amplitude um",
        "friction_force N",
        "intrinsic_friction_force N",
    )
    stated = {f"column {place}": name for place, name in enumerate(names, 1)}
    rows = grid([""] * 5, "LVAFG")[1:]
    return [
        _table(kind, text(rows, ","), statements=stated),
        _table(kind, text(rows, comma=True), statements=stated),
        _table(kind, text(rows, "\t"), statements=stated, suffix=".txt"),
    ]


def _encodings() -> list[LaboratoryTable]:
    kind = "encoding"
    content = "# Prüfstand Müller\n" + text(VOLL, comma=True)
    return [
        _table(kind, content, encoding="cp1252"),
        _table(kind, content, encoding="utf-16"),
        _table(kind, content, encoding="utf-8-sig"),
        _table(kind, content.replace("\n", "\r"), encoding="cp1252"),
    ]


def _cells() -> list[LaboratoryTable]:
    quoted, empty = "quoted cells", "empty columns"
    every = "".join(",".join(f'"{cell}"' for cell in row) + "\n" for row in FULL)
    commas = "".join(",".join(f'"{_with_comma(cell)}"' for cell in row) + "\n" for row in VOLL)
    broken = text([[cell.replace(" [", "\n[") for cell in row] for row in [FULL[0]]], '";"')
    broken = '"' + broken.rstrip("\n") + '"\n' + text(FULL[1:])
    gap = grid(["Load [N]", "", "Speed [mm/s]", "Amplitude [um]", "", "F on [N]", "F off [N]"], "L-VA-FG")
    index = grid(["", *ENGLISH[1:]], "RLVAFG")
    return [
        _table(quoted, every),
        _table(quoted, commas),
        _table(quoted, broken),
        _table(empty, text(gap, ",")),
        _table(empty, "".join(line + ",,,\n" for line in text(FULL, ",").splitlines())),
        _table(empty, text(index, ",")),
    ]


def _turned() -> list[LaboratoryTable]:
    kind = "runs as columns"
    return [
        _table(kind, text([list(row) for row in zip(*FULL, strict=True)], ",")),
        _table(kind, text([list(row) for row in zip(*VOLL, strict=True)], comma=True)),
        _table(
            kind,
            text(
                [
                    [name, unit, *cells]
                    for name, unit, cells in zip(
                        ("Load", "Speed", "Amplitude", "COF on", "COF off"),
                        ("N", "mm/s", "um", "-", "-"),
                        (CELLS[key] for key in "LVAMN"),
                        strict=True,
                    )
                ],
                "\t",
            ),
            suffix=".txt",
        ),
    ]


def _pairs() -> list[LaboratoryTable]:
    kind = "pairs of rows"
    heads = ["Run", "Load [N]", "Speed [mm/s]", "Amplitude [um]"]

    def rows(state: str, off: str, on: str, force: str, *, blank: bool = False) -> Grid:
        found = [[*heads, state, force]]
        for run in zip(CELLS["R"], CELLS["L"], CELLS["V"], CELLS["A"], FORCES, WITHOUT, strict=True):
            *settings, with_, without = run
            found.append([*settings[:3], "" if blank else settings[3], off, without])
            found.append([*settings, on, with_])
        return found

    return [
        _table(kind, text(rows("Ultrasound", "off", "on", "Friction force [N]"), ",")),
        _table(kind, text(rows("US", "aus", "ein", "Reibkraft [N]", blank=True), comma=True)),
        _table(kind, text(rows("Vibration", "0", "1", "Friction force [N]"), "\t"), suffix=".txt"),
        _table(
            kind,
            text([row[:4] + row[5:] for row in rows("", "", "", "Friction force [N]", blank=True)], ",").replace(
                ",,", ",0,"
            ),
        ),
    ]


def _pasted() -> list[LaboratoryTable]:
    kind = "clipboard text"
    heads = [cell.replace(" [", "\n[") for cell in FULL[0]]
    quoted = "\t".join(f'"{cell}"' for cell in heads) + "\r\n" + text(FULL[1:], "\t", end="\r\n")
    return [
        _table(kind, text(FULL, "\t", end="\r\n"), suffix=".txt"),
        _table(kind, text(VOLL, "\t", comma=True, end="\r\n").rstrip(), suffix=".txt"),
        _table(kind, quoted, suffix=".txt"),
    ]


def _spreadsheets() -> list[LaboratoryTable]:
    above: Grid = [[], ["", "Tests of March"], []]
    shifted = [["", *row] for row in FULL]
    notes = [["Operator", "A. Meier"], ["Date", "2026-03-12"]]
    return [
        LaboratoryTable(kind="xlsx", content=xlsx({"Runs": FULL}), right=RIGHT, suffix=".xlsx"),
        LaboratoryTable(kind="xlsx", content=xlsx({"Info": notes, "Runs": VOLL}), right=RIGHT, suffix=".xlsx"),
        LaboratoryTable(kind="xlsx", content=xlsx({"Runs": above + shifted}), right=RIGHT, suffix=".xlsx"),
        LaboratoryTable(kind="ods", content=ods({"Runs": FULL}), right=RIGHT, suffix=".ods"),
        LaboratoryTable(kind="ods", content=ods({"Info": notes, "Runs": VOLL}), right=RIGHT, suffix=".ods"),
        LaboratoryTable(kind="ods", content=ods({"Runs": above + shifted}), right=RIGHT, suffix=".ods"),
    ]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def packed(parts: Mapping[str, str]) -> bytes:
    """Archive of files of text, the first of them not compressed."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for place, (name, content) in enumerate(parts.items()):
            archive.writestr(name, content, zipfile.ZIP_DEFLATED if place else zipfile.ZIP_STORED)
    return out.getvalue()


def xlsx(sheets: Mapping[str, Grid]) -> bytes:
    """Workbook of Office Open XML whose cells are numbers where they can be, else texts in place."""
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    package = "http://schemas.openxmlformats.org/package/2006"
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    kinds = "application/vnd.openxmlformats-officedocument.spreadsheetml"
    parts = [f"xl/worksheets/sheet{number}.xml" for number in range(1, len(sheets) + 1)]
    types = "".join(f'<Override PartName="/{part}" ContentType="{kinds}.worksheet+xml"/>' for part in parts)
    named = "".join(
        f'<sheet name="{name}" sheetId="{number}" r:id="r{number}"/>' for number, name in enumerate(sheets, 1)
    )
    links = "".join(
        f'<Relationship Id="r{number}" Type="{office}/worksheet" Target="worksheets/sheet{number}.xml"/>'
        for number in range(1, len(sheets) + 1)
    )
    return packed(
        {
            "[Content_Types].xml": f'<Types xmlns="{package}/content-types"><Default Extension="rels"'
            ' ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
            f'<Override PartName="/xl/workbook.xml" ContentType="{kinds}.sheet.main+xml"/>{types}</Types>',
            "_rels/.rels": f'<Relationships xmlns="{package}/relationships"><Relationship Id="r1"'
            f' Type="{office}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
            "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships">{links}</Relationships>',
            "xl/workbook.xml": f'<workbook xmlns="{main}" xmlns:r="{office}"><sheets>{named}</sheets></workbook>',
            **{
                part: f'<worksheet xmlns="{main}"><sheetData>{_xlsx_rows(rows)}</sheetData></worksheet>'
                for part, rows in zip(parts, sheets.values(), strict=True)
            },
        }
    )


def _xlsx_rows(rows: Grid) -> str:
    lines = []
    for number, row in enumerate(rows, 1):
        cells = []
        for place, cell in enumerate(row):
            at = f'r="{"ABCDEFGHIJ"[place]}{number}"'
            if _is_number(cell):
                cells.append(f"<c {at}><v>{float(cell)!r}</v></c>")
            elif cell:
                cells.append(f'<c {at} t="inlineStr"><is><t>{escape(cell)}</t></is></c>')
        lines.append(f'<row r="{number}">{"".join(cells)}</row>')
    return "".join(lines)


def ods(sheets: Mapping[str, Grid]) -> bytes:
    """Workbook of OpenDocument whose cells are numbers where they can be, else texts."""
    name = "urn:oasis:names:tc:opendocument:xmlns:{}:1.0".format
    kind = "application/vnd.oasis.opendocument.spreadsheet"
    spaces = " ".join(f'xmlns:{each}="{name(each)}"' for each in ("office", "table", "text"))
    tables = "".join(
        f'<table:table table:name="{title}">{"".join(map(_ods_row, rows))}</table:table>'
        for title, rows in sheets.items()
    )
    return packed(
        {
            "mimetype": kind,
            "META-INF/manifest.xml": f'<manifest:manifest xmlns:manifest="{name("manifest")}"><manifest:file-entry'
            f' manifest:full-path="/" manifest:media-type="{kind}"/><manifest:file-entry'
            ' manifest:full-path="content.xml" manifest:media-type="text/xml"/></manifest:manifest>',
            "content.xml": f"<office:document-content {spaces}><office:body><office:spreadsheet>{tables}"
            "</office:spreadsheet></office:body></office:document-content>",
        }
    )


def _ods_row(row: list[str]) -> str:
    cells = []
    for cell in row or [""]:
        if _is_number(cell):
            kind = f' office:value-type="float" office:value="{float(cell)!r}"'
        else:
            kind = ' office:value-type="string"' if cell else ""
        inside = f"<text:p>{escape(cell)}</text:p>" if cell else ""
        cells.append(f"<table:table-cell{kind}>{inside}</table:table-cell>")
    return f"<table:table-row>{''.join(cells)}</table:table-row>"


LABORATORY_TABLES: Mapping[str, LaboratoryTable] = {
    f"{table.kind} {number}": table
    for number, table in enumerate(
        [
            *_headings(),
            *_ambiguous(),
            *_units(),
            *_percent(),
            *_uncertainties(),
            *_signs(),
            *_separators(),
            *_lines(),
            *_merged(),
            *_without_heads(),
            *_encodings(),
            *_cells(),
            *_turned(),
            *_pairs(),
            *_pasted(),
            *_spreadsheets(),
        ],
        1,
    )
}
"""Every table by its kind and number."""
