"""The page of `pytpc live` in a real browser, on a recording: chromium without a window."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from live_samples import mission as small_mission
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from patience import PATIENCE_S
from pytpc.present.live.assets import page
from pytpc.recording.marks import Mark, read_marks
from pytpc.recording.mission import save_recording
from terminals import pytpc

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(
    CHROMIUM is None or DRIVER is None, reason="chromium and chromedriver are not installed"
)
ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples/recorded_mission"
BEGIN_NS = 10_000_000
"""When the recording of the example begins."""
S = 10**9


def make_browser():
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"):
        options.add_argument(argument)
    options.add_argument("--window-size=1280,900")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options, service=Service(DRIVER))


@pytest.fixture(scope="module")
def browser():
    driver = make_browser()
    try:
        yield driver
    finally:
        driver.quit()


@pytest.fixture
def clean(browser):
    """A browser that remembers nothing; afterwards nothing may have gone wrong in it."""
    browser.get("about:blank")
    browser.get_log("browser")
    yield browser
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    # What the network refuses is in the log, too.
    faults = [one for one in browser.get_log("browser") if one["level"] == "SEVERE"]
    assert [one for one in faults if one["source"] != "network"] == []
    browser.get("about:blank")


class Server:
    """`pytpc live` on a copy of the example."""

    def __init__(self, folder: Path, *options: str) -> None:
        self.mission = folder
        command = pytpc("live", str(folder), "--static", str(folder / "static.json"))
        env = {**os.environ, "PYTHONPATH": str(ROOT), "TPC_FOLDER": str(folder.parent / "tpc")}
        self.process = subprocess.Popen(
            [*command, "--no-browser", *options],
            cwd=folder.parent,
            env=env,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().strip()
        assert self.url.startswith("http://127.0.0.1:")

    @property
    def port(self) -> str:
        found = re.search(r":(\d+)/", self.url)
        assert found
        return found[1]

    def end(self) -> str:
        """What it says after Ctrl-C."""
        self.process.send_signal(signal.SIGINT)
        said, _ = self.process.communicate(timeout=PATIENCE_S)
        assert self.process.returncode == 0
        return said

    def marks(self) -> tuple[Mark, ...]:
        path = self.mission / "marks.csv"
        return read_marks(path) if path.exists() else ()


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[..., Server]]:
    running: list[Server] = []

    def start(*options: str, folder: Path | None = None) -> Server:
        if folder is None:
            folder = tmp_path / "mission"
            if not folder.exists():
                shutil.copytree(EXAMPLE, folder)
        running.append(Server(folder, *options))
        return running[-1]

    yield start
    for one in running:
        if one.process.poll() is None:
            one.process.kill()
        one.process.communicate()


def until(browser, script: str, *arguments):
    return WebDriverWait(browser, PATIENCE_S, 0.05).until(
        lambda driver: driver.execute_script(f"return {script}", *arguments)
    )


def says(browser, selector: str, text: str):
    until(
        browser,
        "(document.querySelector(arguments[0])?.textContent ?? '').includes(arguments[1])",
        selector,
        text,
    )


def opened(browser, server: Server):
    browser.get(server.url)
    until(browser, "document.documentElement.dataset.link === 'open'")
    until(browser, "Number(document.documentElement.dataset.boards) > 0")
    return browser


def press(browser, *keys: str) -> None:
    browser.switch_to.active_element.send_keys(*keys)


def to(browser, seconds: float) -> None:
    """Seek as a person does: with the slider."""
    browser.execute_script(
        "const s = document.getElementById('seek'); s.value = arguments[0];"
        "s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change'));",
        seconds,
    )


def first_names(browser, part: str) -> list[str]:
    return browser.execute_script(
        "return [...document.querySelectorAll(`[data-part=${arguments[0]}] .name`)]"
        ".map((name) => name.textContent)",
        part,
    )


# At 60 s the coverage is just below min_coverage_limit, which was raised; see the example.
def test_it_loads_plays_and_seeks(clean, serve):
    server = serve()
    opened(clean, server)
    assert clean.current_url == f"http://127.0.0.1:{server.port}/"
    says(clean, "#at", "0:00.0 of 1:28.1")
    to(clean, 60)
    says(clean, "#at", "1:00.0 of")
    says(clean, "[data-part=near] li:first-child .name", "~min_coverage_limit")
    says(clean, "[data-part=near] li:first-child .now", "0.051 > 0.058")
    says(clean, "[data-part=held] li:first-child", "/mission/state depends on it")
    says(clean, "#rankings", "~min_coverage_limit")
    assert first_names(clean, "turns")
    clean.find_element(By.ID, "play").click()
    says(clean, "#play", "Pause")
    until(clean, "Number(document.getElementById('seek').value) > 60.5")
    clean.find_element(By.ID, "play").click()
    says(clean, "#play", "Play")
    to(clean, 5)
    says(clean, "#at", "0:05.0 of")
    until(clean, "!document.querySelector('[data-part=near]').textContent.includes('0.051')")


def test_a_reload_needs_no_token(clean, serve):
    opened(clean, serve())
    clean.refresh()
    until(clean, "document.documentElement.dataset.link === 'open'")


def test_a_comparison_shows_its_chart_and_source(clean, serve):
    opened(clean, serve())
    to(clean, 60)
    says(clean, "[data-part=near] li:first-child .name", "~min_coverage_limit")
    clean.find_element(By.CSS_SELECTOR, "[data-part=near] li:first-child button").click()
    says(clean, "#detail-title", "~min_coverage_limit")
    says(clean, "#source", "return coverage > min_coverage_limit_")
    says(clean, "#way", "published on")
    # Bokeh draws in a canvas of its own.
    drawn = "document.querySelector('#chart > div')?.shadowRoot?.childElementCount > 1"
    until(clean, drawn)
    assert not clean.find_element(By.ID, "change").is_displayed()
    press(clean, Keys.ESCAPE)
    until(clean, "document.querySelector('dialog[open]') === null")


def test_marks_by_the_keyboard_alone(clean, serve):
    server = serve()
    opened(clean, server)
    press(clean, Keys.ARROW_UP)
    says(clean, "#at", "1:00.0 of")
    press(clean, "2")
    says(clean, "#said", "marked: type II: 1 ~min_coverage_limit")
    press(clean, "w")
    press(clean, "/camera/capture", Keys.ENTER)
    says(clean, "#said", "wrong at /camera/capture")
    press(clean, "b")
    press(clean, "20-5", Keys.ENTER)
    says(clean, "#said", "it began 20 to 5 s before the mark")
    press(clean, "n")
    # While a note is written, keys are letters.
    press(clean, "no 1 2 u picture", Keys.ENTER)
    says(clean, "#said", "noted")
    press(clean, Keys.ARROW_RIGHT, "1")
    says(clean, "#said", "marked: type I:")
    press(clean, "u")
    says(clean, "#said", "taken back: type I")
    press(clean, "?")
    until(clean, "document.getElementById('help-dialog').open")
    press(clean, Keys.ESCAPE)
    press(clean, "n", Keys.ESCAPE)
    press(clean, " ")
    says(clean, "#play", "Pause")
    press(clean, " ", "+")
    until(clean, "document.getElementById('speed').value === '2'")
    note = "@-20..-5 @/camera/capture no 1 2 u picture"
    assert server.marks() == (Mark(60 * S + BEGIN_NS, "II", "observer", note),)
    assert "1 mark: mission/marks.csv" in server.end()


# Each control is reached by Tab, and shows that it is.
def test_every_control_is_reached_by_tab(clean, serve):
    opened(clean, serve())
    wanted = set(
        clean.execute_script(
            "return [...document.querySelectorAll('button, input, select, a')]"
            ".filter((one) => one.checkVisibility()).map((one) => one.outerHTML)"
        )
    )
    seen = set()
    for _ in range(3 * len(wanted)):
        press(clean, Keys.TAB)
        html, outline = clean.execute_script(
            "const at = document.activeElement;"
            "return [at.outerHTML, getComputedStyle(at).outlineStyle]"
        )
        if html in wanted:
            assert outline == "solid"
            seen.add(html)
        if seen == wanted:
            break
    assert seen == wanted


def test_two_observers_at_once(clean, serve):
    server = serve()
    opened(clean, server)
    other = make_browser()
    try:
        opened(other, server)
        says(clean, "#who", "observer")
        says(other, "#who", "observer2")
        to(clean, 60)
        # They have one clock.
        says(other, "#at", "1:00.0 of")
        press(clean, "1")
        press(other, "2")
        for one in (clean, other):
            says(one, "[data-part=marks]", "should not have observer")
            says(one, "[data-part=marks]", "should be doing observer2")
        other.find_element(By.ID, "who").click()
        press(other, "ana", Keys.ENTER)
        says(other, "#who", "ana")
        press(other, "3")
        says(clean, "[data-part=marks]", "wrong ana")
    finally:
        other.quit()
    assert {(mark.observer, mark.type) for mark in server.marks()} == {
        ("observer", "I"),
        ("observer2", "II"),
        ("ana", None),
    }


# A mark that is pressed while the server is away is shown as waiting, and arrives with its time.
def test_a_mark_waits_for_the_connection(clean, serve, tmp_path):
    server = serve()
    opened(clean, server)
    to(clean, 30)
    says(clean, "#at", "0:30.0 of")
    os.kill(server.process.pid, signal.SIGSTOP)
    says(clean, "#banner", "No connection to pytpc live since")
    assert clean.find_element(By.ID, "board").get_attribute("class") == "old"
    press(clean, "2")
    says(clean, "#said", "waiting for the connection (1)")
    says(clean, "#banner", "1 waiting to be sent")
    os.kill(server.process.pid, signal.SIGCONT)
    until(clean, "document.getElementById('banner').hidden")
    says(clean, "#said", "marked: type II")
    until(clean, "document.getElementById('board').className === ''")
    assert server.marks() == (Mark(30 * S + BEGIN_NS, "II", "observer"),)


def test_a_server_that_was_started_again_is_told(clean, serve):
    first = serve("--port", "0")
    opened(clean, first)
    port = first.port
    first.end()
    says(clean, "#banner", "No connection")
    serve("--port", port)
    says(clean, "#banner", "pytpc live was started again")


@pytest.mark.parametrize("dark", [False, True])
def test_on_a_phone_nothing_is_cut_and_buttons_are_large(clean, serve, dark: bool):
    metrics = {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}
    clean.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    scheme = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
    clean.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": scheme})
    opened(clean, serve())
    to(clean, 60)
    says(clean, "[data-part=near]", "0.051 > 0.058")
    assert clean.execute_script("return document.documentElement.scrollWidth") == 390
    small = clean.execute_script(
        "return [...document.querySelectorAll('button, input, select')]"
        ".filter((one) => one.checkVisibility())"
        ".filter((one) => { const box = one.getBoundingClientRect();"
        " return box.width < 44 || box.height < 44 }).map((one) => one.outerHTML)"
    )
    assert small == []
    back = clean.execute_script("return getComputedStyle(document.body).backgroundColor")
    assert back == ("rgb(16, 18, 21)" if dark else "rgb(243, 245, 247)")


HOSTILE = (
    "</script><script>alert(1)</script>",
    "<img src=x onerror=alert(2)>",
    "'\"><b onmouseover=alert(3)>",
    "\u202egnp.exe\u2066${alert(4)}{{7*7}}`x`",
)


# Names of parameters and topics, a note and the name of the recording: shown as text alone.
def test_hostile_names_are_text(clean, serve, tmp_path):
    static, recording = small_mission(HOSTILE)
    folder = tmp_path / "<img src=x onerror=alert(5)>"
    folder.mkdir()
    static.save(folder / "static.json")
    save_recording(recording, folder)
    server = serve(folder=folder)
    opened(clean, server)
    to(clean, 36)
    says(clean, "[data-part=near]", "<script>alert(1)</script>")
    says(clean, "[data-part=turns]", "onmouseover=alert(3)")
    press(clean, "1")
    says(clean, "#said", "marked")
    press(clean, "n")
    press(clean, "<img src=x onerror=alert(6)>", Keys.ENTER)
    says(clean, "[data-part=marks]", "<img src=x onerror=alert(6)>")
    clean.find_element(By.CSS_SELECTOR, "[data-part=near] li:first-child button").click()
    until(clean, "document.getElementById('detail-dialog').open")
    assert (
        clean.find_elements(By.CSS_SELECTOR, "img[src='x'], b[onmouseover], script:not([src])")
        == []
    )
    assert "\u202e" not in clean.execute_script("return document.body.innerText")
    # No alert is open: this would raise.
    assert clean.title == "pytpc live"


def test_a_value_is_changed_only_after_its_diff(clean, serve, tmp_path):
    server = serve("--allow-apply")
    opened(clean, server)
    to(clean, 60)
    says(clean, "[data-part=near] li:first-child .name", "~min_coverage_limit")
    clean.find_element(By.CSS_SELECTOR, "[data-part=near] li:first-child button").click()
    until(clean, "document.getElementById('detail-dialog').open")
    clean.find_element(By.CSS_SELECTOR, "#change input").send_keys("0.035", Keys.ENTER)
    # This recording does not say where its values came from.
    says(clean, "#change [role=status]", "no origins.json")
    assert not clean.find_element(By.ID, "apply").is_displayed()


def luminance(colour: str) -> float:
    parts = [int(colour[n : n + 2], 16) / 255 for n in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.03928 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


# WCAG 2, level AA: 4.5 for texts, 3 for what is drawn.
@pytest.mark.parametrize("dark", [False, True])
def test_texts_have_enough_contrast(dark: bool):
    css = (ROOT / "pytpc/present/live/web/live.css").read_text("utf-8")
    blocks = re.findall(r":root \{(.*?)\}", css, re.DOTALL)
    colours = dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", blocks[int(dark)]))
    for text in ("ink", "faint", "value", "alert"):
        for back in ("paper", "back"):
            assert contrast(colours[text], colours[back]) >= 4.5, (text, back)
    assert contrast(colours["alert"], colours["alert-back"]) >= 4.5
    assert contrast(colours["ink"], colours["here"]) >= 4.5
    for button in ("one", "two", "three"):
        assert contrast("#ffffff", colours[button]) >= 4.5


# The policy of the page allows none.
def test_the_page_has_no_script_or_handler_of_its_own():
    text = page().data.decode()
    assert re.findall(r"<script(?![^>]*\ssrc=)", text) == []
    assert re.findall(r"\son\w+=", text) == []
    assert "http://" not in text
    assert "https://" not in text
