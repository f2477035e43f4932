"""A user's task walked through by keyboard or by mouse: the same steps by either, with a picture of each on request.

A test takes the hand as a parameter and says what its user does:

>>> @pytest.mark.parametrize("hand", HANDS)
... def test_a_rig_is_changed(hand: type[Mouse], page: Page) -> None:
...     walk = hand(page, "tribologist")
...     walk.press("page:predict")
...     walk.write("field:drive.voltage_peak_to_peak", "14 V")
...     walk.picture("halved")

`SONOLUBE_PICTURES=FOLDER pytest ...` keeps the pictures as FOLDER/tribologist-keyboard-1-halved.png.
"""

import os
from pathlib import Path

from playwright.sync_api import Page, expect
from tests.browser.pages import at_rest, in_use

MAX_STOPS = 300  # of the tab key
_SHOWN = """() => {
  const here = document.activeElement, box = here.getBoundingClientRect();
  const near = [here, here.nextElementSibling, ...here.querySelectorAll('*')].filter(Boolean).map(
    (each) => getComputedStyle(each));
  return here.matches(':focus-visible') && box.bottom > 0 && box.top < innerHeight && box.right > 0
    && box.left < innerWidth && near.some(({outlineStyle, outlineWidth, strokeWidth}) => parseFloat(strokeWidth) >= 2
      || (outlineStyle !== 'none' && parseFloat(outlineWidth) > 0));
}"""


class Mouse:
    """A user with a mouse; elements are named by their `data-test`."""

    name = "mouse"

    def __init__(self, page: Page, task: str) -> None:
        self.page, self.task, self.shots = page, task, 0

    def press(self, test: str) -> None:
        """Press a button or link, or tick a checkbox."""
        if test.startswith("page:") and not self.page.get_by_test_id(test).is_visible():
            self.press("more")
        self.page.get_by_test_id(test).first.click()

    def write(self, test: str, text: str, *, rests: bool = True) -> None:
        """Write into a field, enter it, and wait until the page rests."""
        self._write(test, text)
        self.page.keyboard.press("Enter")
        if rests:
            at_rest(self.page)

    def _write(self, test: str, text: str) -> None:
        self.page.get_by_test_id(test).first.fill(text)

    def choose(self, test: str, value: str) -> None:
        """Choose in a list of choices (select) by value."""
        self.page.get_by_test_id(test).first.select_option(value)

    def pick(self, test: str) -> None:
        """Pick one of a group of radio buttons."""
        self.page.get_by_test_id(test).first.check()

    def give(self, test: str, *files: Path) -> None:
        """Give files to a field of files."""
        with self.page.expect_file_chooser() as chooser:
            self.press(test)
        chooser.value.set_files([str(each) for each in files])

    def picture(self, name: str) -> None:
        """Keep a picture of the page, where `SONOLUBE_PICTURES` names a folder."""
        self.shots += 1
        if folder := os.environ.get("SONOLUBE_PICTURES"):
            self.page.screenshot(path=Path(folder) / f"{self.task}-{self.name}-{self.shots}-{name}.png")


class Keyboard(Mouse):
    """A user with a keyboard alone, who sees at each stop where the focus is."""

    name = "keyboard"

    def reach(self, *tests: str) -> None:
        """Go by the tab key to the first of some elements that it meets, once one is there and enabled."""
        expect(self.page.locator(", ".join(f'[data-test="{each}"]' for each in tests)).first).to_be_enabled()
        for _ in range(MAX_STOPS):
            if in_use(self.page) in tests:
                break
            self.page.keyboard.press("Tab")
        else:
            raise AssertionError(f"no stop of the tab key at {', '.join(tests)}")
        assert self.page.evaluate(_SHOWN), f"the focus is not seen at {in_use(self.page)}"

    def press(self, test: str, key: str = "") -> None:
        if test.startswith("page:") and not self.page.get_by_test_id(test).is_visible():
            self.press("more")
        self.reach(test)
        is_box = self.page.evaluate("['checkbox', 'file'].includes(document.activeElement.type)")
        self.page.keyboard.press(key or ("Space" if is_box else "Enter"))

    def _write(self, test: str, text: str) -> None:
        self.reach(test)
        self.page.keyboard.press("Control+A")
        self.page.keyboard.type(text)

    def choose(self, test: str, value: str) -> None:
        self.reach(test)
        self.page.keyboard.press("Home")
        self._down_until("document.activeElement.value === wanted", value)

    def pick(self, test: str) -> None:
        group = self.page.get_by_test_id(test).first.evaluate(
            "(each) => [...document.getElementsByName(each.name)].map((one) => one.dataset.test)"
        )
        self.reach(*group)
        self._down_until("document.activeElement.dataset.test === wanted", test)
        self.page.keyboard.press("Space")
        expect(self.page.get_by_test_id(test).first).to_be_checked()

    def _down_until(self, condition: str, wanted: str) -> None:
        for _ in range(MAX_STOPS):
            if self.page.evaluate(f"(wanted) => {condition}", wanted):
                return
            self.page.keyboard.press("ArrowDown")
        raise AssertionError(f"the arrows do not lead to {wanted}")


HANDS = (Mouse, Keyboard)
