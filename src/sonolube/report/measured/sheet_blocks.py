"""Sheets of measured files as blocks of text."""

from sonolube.report.blocks import Block, Rows, Table as TextTable
from sonolube.report.measured.sheet import Sheet


def sheet_blocks(sheet: Sheet) -> list[Block]:
    """Title, size, values and tables of a sheet, and what was not found; caveats apart."""
    blocks: list[Block] = [sheet.title, *(f"  {name}: {text}" for name, text in sheet.size().items())]
    blocks.append(Rows([(value.label, value.text) for value in sheet.values]))
    for table in sheet.tables:
        blocks += ["", f"  {table.title}", TextTable(*table.texts())]
    return [*blocks, *(f"  not found: {reason}" for reason in sheet.not_found)]
