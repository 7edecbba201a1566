"""Draw the picture of an answer that the README shows, from a report page, by chromium.

``draw_answer.py [PAGE [MISSION]] [-o FILE]``: PAGE is a page of ``pytpc report`` or of the demo
(default: out/demo/report.html). MISSION is a mission's name on it; without one it is the first one
with something to try. It needs chromium, chromedriver and selenium, which ``make test`` installs.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

ROOT = Path(__file__).resolve().parent.parent
WIDTH, HEIGHT, PAGE_HEIGHT = 1120, 1600, 1150
PATIENCE_S = 60

# The section of the mission that is drawn; its figure counts as drawn when Bokeh has drawn it.
CHOOSE = """
const panels = [...document.querySelectorAll("section.mission")];
const panel = panels.find((one) => arguments[0] === null
  ? one.querySelector(".claim.act") : one.querySelector("h2").textContent.trim() === arguments[0]);
if (!panel) return null;
location.hash = panel.querySelector("h2").id;
return panel.id;
"""
READY = """
const panel = document.getElementById(arguments[0]);
const figure = panel.querySelector(".lead .figure");
const isDrawn = figure === null || figure.querySelector(".moving-figure div") !== null;
return isDrawn && !panel.classList.contains("away");
"""
# What a picture cannot use.
BARE = """
for (const one of document.querySelectorAll(".next, .controls, .readout")) one.hidden = true;
"""


def main() -> None:
    """Read the arguments and draw."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("page", nargs="?", type=Path, default=ROOT / "out/demo/report.html")
    parser.add_argument("mission", nargs="?")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs/images/answer.png")
    given = parser.parse_args()
    if not given.page.is_file():
        sys.exit(
            f"draw-answer: {given.page}: no such page; `make demo` writes out/demo/report.html"
        )
    given.output.write_bytes(picture(given.page, given.mission))
    print(given.output)


def picture(page: Path, mission: str | None) -> bytes:
    """The answer about a mission as PNG, in light colours."""
    with opened(page, mission, HEIGHT) as (browser, panel):
        browser.execute_script(BARE)
        shot: bytes = browser.find_element(By.CSS_SELECTOR, f"#{panel} .answer").screenshot_as_png
        return shot


def page_picture(page: Path, mission: str | None) -> bytes:
    """The page as it opens at a mission, as PNG, in light colours."""
    with opened(page, mission, PAGE_HEIGHT) as (browser, panel):
        browser.execute_script("arguments[0].scrollIntoView()", browser.find_element(By.ID, panel))
        shot: bytes = browser.get_screenshot_as_png()
        return shot


@contextmanager
def opened(page: Path, mission: str | None, height: int) -> Iterator[tuple[webdriver.Chrome, str]]:
    """A browser in which a mission of a page is drawn, and the id of its section."""
    programs = [shutil.which(name) for name in ("chromium", "chromedriver")]
    if None in programs:
        sys.exit("draw-answer: chromium and chromedriver are not installed; `make test` does that")
    options = webdriver.ChromeOptions()
    options.binary_location = str(programs[0])
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--disable-dev-shm-usage",
        "--disable-gpu",
        "--hide-scrollbars",
    ):
        options.add_argument(argument)
    options.add_argument(f"--window-size={WIDTH},{height}")
    browser = webdriver.Chrome(options=options, service=Service(str(programs[1])))
    try:
        browser.get(page.absolute().as_uri())
        panel = browser.execute_script(CHOOSE, mission)
        if panel is None:
            which = "no mission with something to try" if mission is None else f"no {mission}"
            sys.exit(f"draw-answer: {page}: {which}")
        patience = WebDriverWait(browser, PATIENCE_S)
        patience.until(lambda driver: driver.execute_script(READY, panel))
        yield browser, panel
    finally:
        browser.quit()


if __name__ == "__main__":
    main()
