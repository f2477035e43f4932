"""The table of own runs in a real browser: pasted, edited, switched off, undone and removed; the prediction follows."""

from playwright.sync_api import Page, expect
from tests.browser.pages import at_rest

ROWS = "Amplitude [um]\tSpeed [mm/s]\tCOF on\tCOF off\n" + "\n".join(
    ["2,5\t30\t0,18\t0,38", "2,5\t60\t0,27\t0,38", "1,2\t30\t0,30\t0,38", "2,5\t32\t0,19\t0,38", "2,4\t30\t0,36\t0,38"]
)


def test_rows_of_a_spreadsheet_are_seen_changed_and_kept(page: Page) -> None:
    alone = page.get_by_test_id("statement").inner_text()
    page.get_by_test_id("paste-runs").fill(ROWS)
    expect(page.get_by_test_id("runs-note")).to_contain_text("5 own runs.")
    at_rest(page)
    narrowed = page.get_by_test_id("statement").inner_text()
    assert narrowed != alone
    expect(page.get_by_test_id("runs-table").get_by_text("disagrees with the others")).to_have_count(1)

    page.get_by_test_id("use-run").nth(4).uncheck()
    expect(page.get_by_test_id("runs-note")).to_contain_text("5 own runs, 1 of them switched off.")
    expect(page.get_by_test_id("runs-table").get_by_text("disagrees with the others")).to_have_count(0)
    at_rest(page)
    without = page.get_by_test_id("statement").inner_text()
    page.reload()
    expect(page.get_by_test_id("statement")).to_have_text(without)
    expect(page.get_by_test_id("use-run").nth(4)).not_to_be_checked()

    page.get_by_test_id("cell:1:sliding_speed").fill("0.5 N")
    page.get_by_test_id("cell:1:sliding_speed").press("Tab")
    expect(page.get_by_test_id("runs-note")).to_contain_text("sliding speed 0.5 N is a force")
    page.get_by_test_id("cell:1:sliding_speed").fill("0.07 m/s")
    page.get_by_test_id("cell:1:sliding_speed").press("Tab")
    expect(page.get_by_test_id("cell:1:sliding_speed")).to_have_value("70")

    page.get_by_test_id("remove-run").nth(4).click()
    expect(page.get_by_test_id("runs-note")).to_contain_text("4 own runs.")
    page.get_by_test_id("statement").click()
    page.keyboard.press("Control+z")
    expect(page.get_by_test_id("runs-note")).to_contain_text("5 own runs, 1 of them switched off.")
    page.get_by_test_id("paste-runs").fill(ROWS)  # the row that was edited is none of the table any more
    expect(page.get_by_test_id("runs-note")).to_contain_text("6 own runs, 1 of them switched off.")
    page.get_by_test_id("paste-runs").fill(ROWS)
    expect(page.get_by_test_id("runs-note")).to_have_text("These rows are in the table already.")


def test_a_run_is_typed_into_an_empty_table(page: Page) -> None:
    at_rest(page)
    for name, text in (("friction_force", "0.5"), ("intrinsic_friction_force", "1.0"), ("sliding_speed", "20")):
        page.get_by_test_id(f"cell:0:{name}").fill(text)
        page.get_by_test_id(f"cell:0:{name}").press("Tab")
        expect(page.get_by_test_id(f"cell:0:{name}")).to_have_value(text)
        expect(page.get_by_test_id("runs-note")).to_contain_text("1 own run.")
    page.get_by_test_id("add-column").select_option("normal_load")
    expect(page.get_by_test_id("cell:0:normal_load")).to_be_visible()
    at_rest(page)
