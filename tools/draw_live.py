"""Draw the pictures of `pytpc live`, from the recorded mission in a real browser.

``draw_live.py`` draws the one picture of the documentation. ``draw_live.py --all FOLDER`` draws
others, to look at: desktop and phone, light and dark, a comparison, a lost connection.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

ROOT = Path(__file__).resolve().parents[1]
PICTURE = ROOT / "docs/images/live.png"
EXAMPLE = ROOT / "examples/recorded_mission"
PATIENCE_S = 60.0
DESKTOP, PHONE = (1280, 900, False), (390, 844, True)


def browser() -> webdriver.Chrome:
    """Debian's chromium, without a window."""
    options = webdriver.ChromeOptions()
    options.binary_location = str(shutil.which("chromium"))
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"):
        options.add_argument(argument)
    return webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))


class Pictures:
    """Takes pictures of one server's page."""

    def __init__(self, driver: webdriver.Chrome, url: str) -> None:
        self.driver = driver
        self.url = url

    def until(self, script: str) -> None:
        """Wait until it is so."""
        wait = WebDriverWait(self.driver, PATIENCE_S, 0.1)
        wait.until(lambda driver: driver.execute_script(f"return {script}"))

    def open(self, size: tuple[int, int, bool], *, dark: bool = False) -> None:
        """Open the page, with a window of this size."""
        width, height, is_phone = size
        metrics = {"width": width, "height": height, "mobile": is_phone}
        metrics["deviceScaleFactor"] = 2 if is_phone else 1
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        scheme = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": scheme})
        self.driver.get(self.url)
        self.until("document.querySelectorAll('[data-part=near] li, [data-part=marks] li').length")

    def press(self, *keys: str) -> None:
        """Press keys."""
        self.driver.switch_to.active_element.send_keys(*keys)

    def take(self, path: Path) -> None:
        """Take a picture when the page has come to rest."""
        time.sleep(1.0)
        self.driver.save_screenshot(str(path))
        print(path)


def mark(pictures: Pictures) -> None:
    """One mark at a minute, with where."""
    pictures.press(Keys.ARROW_UP)
    pictures.until("document.getElementById('at').textContent.startsWith('1:00.0')")
    pictures.press("2")
    pictures.until("document.getElementById('said').textContent.startsWith('marked')")
    pictures.press("w")
    pictures.press("/camera/capture", Keys.ENTER)
    pictures.until("document.getElementById('said').textContent.startsWith('wrong at')")


def others(pictures: Pictures, folder: Path, stop: Callable[[], None]) -> None:
    """The pictures to look at."""
    folder.mkdir(parents=True, exist_ok=True)
    pictures.open(DESKTOP, dark=True)
    pictures.take(folder / "desktop-dark.png")
    pictures.open(PHONE)
    pictures.take(folder / "phone.png")
    for part in ("held", "suspects", "marks"):
        pictures.driver.execute_script(f"document.getElementById('{part}').scrollIntoView()")
        pictures.take(folder / f"phone-{part}.png")
    pictures.open(PHONE, dark=True)
    pictures.take(folder / "phone-dark.png")
    pictures.open(DESKTOP)
    pictures.driver.find_element(By.CSS_SELECTOR, "[data-part=near] button").click()
    pictures.until("document.getElementById('detail-dialog').open")
    drawn = "document.querySelector('#chart > div')?.shadowRoot?.childElementCount > 1"
    pictures.until(drawn)
    pictures.take(folder / "comparison.png")
    pictures.press(Keys.ESCAPE)
    pictures.press("?")
    pictures.take(folder / "keys.png")
    pictures.press(Keys.ESCAPE)
    stop()
    pictures.until("!document.getElementById('banner').hidden")
    pictures.press("1")
    pictures.take(folder / "lost.png")


def main() -> None:
    """Draws."""
    parser = argparse.ArgumentParser(description="Draw the page of pytpc live.")
    parser.add_argument("--all", type=Path, metavar="FOLDER", help="Draw pictures to look at.")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        mission = shutil.copytree(EXAMPLE, Path(scratch) / "image_capture")
        command = [sys.executable, "-m", "pytpc", "live", str(mission), "--no-browser"]
        server = subprocess.Popen(
            [*command, "--static", str(mission / "static.json")],
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE,
            text=True,
        )
        assert server.stdout is not None
        driver = browser()
        try:
            pictures = Pictures(driver, server.stdout.readline().strip())
            driver.get(pictures.url)
            pictures.until("Number(document.documentElement.dataset.boards) > 0")
            mark(pictures)
            pictures.open(DESKTOP)
            pictures.take(PICTURE)
            if given.all:
                others(pictures, given.all, lambda: server.send_signal(signal.SIGSTOP))
        finally:
            driver.quit()
            server.send_signal(signal.SIGCONT)
            server.terminate()
            server.wait(PATIENCE_S)


if __name__ == "__main__":
    main()
