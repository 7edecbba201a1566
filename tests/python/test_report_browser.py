"""The report page in a real browser: Debian's chromium, without a window."""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import time
from dataclasses import replace
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from mission_samples import comparison, events, key, ns, static_info
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from pytpc.api.comparing import RecordedRun, beside
from pytpc.api.report import MissionReport, write_missions
from pytpc.diagnosis.differences import changes_of
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import PathStep

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(
    CHROMIUM is None or DRIVER is None, reason="chromium and chromedriver are not installed"
)
PATIENCE_S = 30
HOSTILE = (
    "</script><script>alert(1)</script>",
    "<img src=x onerror=alert(2)>",
    "'\"><b onmouseover=alert(3)>",
    "a\nb\r\tc\u2028d",
    "\u202egnp.exe\u2066",
    "nul\x00nul",
    "${alert(4)}{{7*7}}`alert(5)`",
    "$$\\href{javascript:alert(6)}{x}$$ \\[y\\] @{x}{safe}",
    "<!--<script>",
    "&lt;b&gt;",
)


@pytest.fixture(scope="module")
def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"):
        options.add_argument(argument)
    options.add_argument("--window-size=1280,900")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    try:
        yield driver
    finally:
        driver.quit()


def mission(names=("faces", "coverage", "speed"), **changes):
    """40 s at 10 Hz: the second parameter's value stays below its limit, the others flop.

    Two marks of type II. At both the second is first: its window of 12 s has no flop and a mean
    distance of some 0.1 of 0.6; the first is 2 of 4 away from its limit, the third flops.
    """
    static = static_info(
        comparison(0, names[0], ">=", default=3),
        comparison(1, names[1], path=(PathStep("read", "a.cpp", 3, 1, "f", names[1], names[1]),)),
        comparison(2, names[2], "<", topic=names[2], function=names[2], file=names[2]),
        *(comparison(3 + n, f"more{n}") for n in range(9)),
    )
    rows = []
    for step in range(400):
        t = step / 10
        rows += [
            (t, 0, t >= 38, 4 if t >= 38 else 1, 3),
            (t, 1, False, min(0.5, t / 30), 0.6),
            (t, 2, step % 50 < 25, step % 50, 25),
        ]
        rows += [(t, 3 + n, False, -n, 10) for n in range(9)]
    recording = Recording(
        "flight",
        events(rows, node=f"/{names[0]}"),
        (Mark(ns(30), "II", names[1], names[2]), Mark(ns(35), "II")),
        0,
        ns(40),
    )
    report = MissionReport("flight", recording, static, rank_marks(recording, static))
    return replace(report, **changes)


@pytest.fixture
def opened(browser, tmp_path):
    """Opens a page with a mission; afterwards nothing may have gone wrong, or been asked for."""
    path = tmp_path / "report.html"

    def of(*missions, script=True):
        write_missions(path, missions)
        browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": not script})
        browser.get("about:blank")
        browser.get_log("browser"), browser.get_log("performance")
        browser.get(path.as_uri())
        if script:
            wait(browser, "return document.documentElement.classList.contains('ready')")
        return browser

    yield of
    browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})
    faults = [entry for entry in browser.get_log("browser") if entry["level"] != "INFO"]
    assert faults == []
    assert requests(browser) == {path.as_uri()}


def requests(browser):
    """All addresses that were asked for; what the page carries itself has none."""
    found = set()
    for entry in browser.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] in {"Network.requestWillBeSent", "Network.webSocketCreated"}:
            params = message["params"]
            found.add(params.get("url") or params["request"]["url"].partition("#")[0])
    return {address for address in found if not address.startswith("data:")}


def wait(browser, script, *arguments):
    return WebDriverWait(browser, PATIENCE_S, 0.05).until(
        lambda driver: driver.execute_script(script, *arguments)
    )


def element(browser, selector):
    return browser.find_element(By.CSS_SELECTOR, selector)


def drawn(browser, selector):
    """The figure, scrolled to and drawn."""
    figure = element(browser, selector)
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", figure)
    wait(browser, "return arguments[0].classList.contains('drawn')", figure)
    return figure


def shown_range(browser, figure):
    return browser.execute_script(
        "const r = arguments[0].tpcRange; return [r.start, r.end]", figure
    )


def mouse(browser, kind, x, y, **more):
    browser.execute_cdp_cmd("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, **more})


def visible(browser, selector):
    found = browser.find_elements(By.CSS_SELECTOR, selector)
    return [one.text for one in found if one.is_displayed()]


ANSWER = ".lead .figure"
TIMELINE = "[data-timeline]"
ROWS = "#m1-1 table.ranking tbody tr"


def accused(**changes):
    """More marks, beside a good run in which coverage had 0.25, so that coverage is to blame."""
    report = mission(**changes)
    told = report.recording.marks[0]
    marks = tuple(replace(told, time_ns=ns(second)) for second in (16, 20, 24, 28, 31))
    recording = replace(report.recording, marks=marks)
    rankings = rank_marks(recording, report.static_info)
    report = replace(report, recording=recording, rankings=rankings)
    table = report.recording.events
    own = table.key == table.keys.index(key(1))
    seen = replace(table, thresh=np.where(own, 0.25, table.thresh))
    run = RecordedRun(replace(report.recording, name="monday", events=seen, marks=()))
    static = report.static_info
    question = beside(report.question, [run], RecordedRun(report.recording), static, static)
    assert question.differences is not None
    # As if the values of all parameters were known of both.
    return replace(report, question=replace(question, changes=changes_of(question.differences)))


def phone(browser):
    size = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)


@pytest.fixture
def on_a_phone(browser):
    phone(browser)
    yield
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def unfold(browser, ident):
    browser.execute_script("document.getElementById(arguments[0]).open = true", ident)


def test_the_first_screen_has_the_answer(opened):
    browser = opened(accused())
    verdict, action = browser.find_elements(By.CSS_SELECTOR, ".answer .claim")
    assert verdict.text.startswith("Blame coverage: ")
    assert " ".join(action.text.split()).startswith("▼ Lower coverage from 0.6 to 0.25 (")
    window = browser.execute_script("return innerHeight")
    assert action.location["y"] < window / 2
    assert element(browser, ".differences table").location["y"] < window
    drawn(browser, ANSWER)
    # The figure that moves stands in the place of the other.
    assert not element(browser, f"{ANSWER} .still").is_displayed()
    assert element(browser, f"{ANSWER} .moving-figure").size["height"] > 200
    assert "to try: 0.25" in element(browser, f"{ANSWER} .legend").text


def test_a_phone_shows_the_suspect_and_the_value(opened, on_a_phone):
    browser = opened(accused())
    for claim in browser.find_elements(By.CSS_SELECTOR, ".answer .claim"):
        assert claim.location["y"] + claim.size["height"] < 844
    drawn(browser, ANSWER)
    drawn(browser, TIMELINE)
    assert browser.execute_script("return document.documentElement.scrollWidth") <= 390
    # The table of differences is a list there.
    assert not element(browser, ".differences thead").is_displayed()


def test_several_missions_are_tabs(opened):
    browser = opened(*(mission(name=name) for name in ("one", "two", "three")))
    panels = "section.mission"
    heads = lambda: [text.splitlines()[0] for text in visible(browser, panels)]  # noqa: E731
    assert element(browser, "#overview").is_displayed()
    assert heads() == ["one"]
    tab = element(browser, "#m1-tab")
    assert tab.get_attribute("aria-selected") == "true"
    tab.send_keys(Keys.ARROW_RIGHT)
    assert heads() == ["two"]
    browser.switch_to.active_element.send_keys(Keys.END)
    assert heads() == ["three"]
    browser.switch_to.active_element.send_keys(Keys.ARROW_RIGHT)
    assert heads() == ["one"]
    element(browser, ".overview a[href='#m2']").click()
    wait(browser, "return !document.getElementById('m2-panel').classList.contains('away')")
    assert heads() == ["two"]
    # A link to a card shows its mission.
    browser.execute_script("location.hash = '#m3-2-1'")
    wait(browser, "return document.getElementById('m3-2').open")
    assert heads() == ["three"]
    assert element(browser, "#m3-2-1 .why").is_displayed()


def test_without_a_script_all_missions_can_be_read(opened):
    browser = opened(mission(name="one"), mission(name="two"), script=False)
    found = visible(browser, "section.mission")
    assert [text.splitlines()[0] for text in found] == ["one", "two"]


def test_a_term_is_explained_by_keyboard_pointer_and_tap(opened):
    browser = opened(mission())
    term = element(browser, ".judged .term")
    said = "The robot should be doing something, and does not."
    assert term.text == "type II"
    described = term.get_attribute("aria-describedby")
    assert element(browser, f"#{described}").text == said
    assert visible(browser, ".tip") == []
    browser.execute_script("arguments[0].focus()", term)
    assert visible(browser, ".tip") == [said]
    term.send_keys(Keys.ESCAPE)
    assert visible(browser, ".tip") == []
    ActionChains(browser).move_to_element(term).perform()
    assert visible(browser, ".tip") == [said]
    ActionChains(browser).move_to_element(element(browser, "h1")).perform()
    assert visible(browser, ".tip") == []
    term.click()
    assert visible(browser, ".tip") == [said]
    assert browser.execute_script("return location.hash") == ""


def test_search_shows_what_has_all_the_words(opened):
    browser = opened(mission())
    unfold(browser, "m1-1")
    box = element(browser, "input[type=search]")
    # Of 12 rows 8 are listed at first, a search looks in all.
    assert len(visible(browser, ROWS)) == 8
    box.send_keys("MORE8 node.cpp")
    assert [row.split()[1] for row in visible(browser, ROWS)] == ["more8"]
    assert element(browser, ".found").text == "2 rows found"
    box.send_keys(Keys.CONTROL, "a")
    box.send_keys("nobody")
    assert visible(browser, "details.mark") == []
    box.send_keys(Keys.CONTROL, "a")
    box.send_keys(Keys.DELETE)
    assert len(visible(browser, ROWS)) == 8


def test_a_column_sorts_both_ways_by_keyboard(opened):
    browser = opened(mission())
    unfold(browser, "m1-1")
    element(browser, "#m1-1 button.more").click()
    head = element(browser, "#m1-1 th[data-sort=parameter]")
    head.find_element(By.TAG_NAME, "button").send_keys(Keys.ENTER)
    names = [row.split()[1] for row in visible(browser, ROWS)]
    assert names == sorted(names)
    assert len(names) == 12
    assert head.get_attribute("aria-sort") == "ascending"
    head.find_element(By.TAG_NAME, "button").send_keys(Keys.SPACE)
    assert [row.split()[1] for row in visible(browser, ROWS)] == names[::-1]
    assert head.get_attribute("aria-sort") == "descending"
    # Numbers are sorted as numbers.
    element(browser, "#m1-1 th[data-sort=current] button").click()
    values = [float(row.split()[2]) for row in visible(browser, ROWS)]
    assert values == sorted(values)


# The answer's figure begins 20 s before the mark at 30 s and ends 6 s after it, with a hundredth of
# that at each end: from 9.74 to 36.26. Half of it around the middle of 23 is 16.37 to 29.63; a
# fifth of that, 2.652, is one step of an arrow.
def test_zoom_and_pan_by_buttons_and_keys(opened):
    browser = opened(mission())
    figure = drawn(browser, ANSWER)
    assert shown_range(browser, figure) == pytest.approx([9.74, 36.26])
    element(browser, f"{ANSWER} [aria-label='Zoom in']").click()
    assert shown_range(browser, figure) == pytest.approx([16.37, 29.63])
    figure.send_keys(Keys.ARROW_RIGHT)
    assert shown_range(browser, figure) == pytest.approx([19.022, 32.282])
    figure.send_keys("-")
    figure.send_keys("-")
    figure.send_keys("-")
    # Nothing lies outside of the mission.
    assert shown_range(browser, figure) == pytest.approx([0, 40])
    figure.send_keys("0")
    assert shown_range(browser, figure) == pytest.approx([9.74, 36.26])


def test_drag_and_wheel(opened):
    browser = opened(mission())
    figure = drawn(browser, TIMELINE)
    begin, end = shown_range(browser, figure)
    assert (begin, end) == pytest.approx((-0.24, 40.24))
    x, y = browser.execute_script(
        "const b = arguments[0].querySelector('.moving-figure').getBoundingClientRect();"
        "return [b.x + b.width / 2, b.y + b.height / 4]",
        figure,
    )
    time.sleep(0.5)
    mouse(browser, "mouseMoved", x, y)
    # Without Ctrl the wheel moves the page.
    mouse(browser, "mouseWheel", x, y, deltaX=0, deltaY=-30)
    mouse(browser, "mouseWheel", x, y, deltaX=0, deltaY=-300, modifiers=2)
    wait(browser, "const r = arguments[0].tpcRange; return r.end - r.start < 30", figure)
    before = shown_range(browser, figure)
    mouse(browser, "mousePressed", x, y, button="left", clickCount=1)
    for step in range(1, 11):
        mouse(browser, "mouseMoved", x + 12 * step, y, button="left", buttons=1)
    mouse(browser, "mouseReleased", x + 120, y, button="left")
    wait(browser, "return arguments[0].tpcRange.start < arguments[1] - 0.5", figure, before[0])
    after = shown_range(browser, figure)
    assert after[1] - after[0] == pytest.approx(before[1] - before[0])


def test_the_pointer_reads_values(opened):
    browser = opened(accused())
    figure = drawn(browser, ANSWER)
    canvas = element(browser, f"{ANSWER} .moving-figure")
    time.sleep(0.5)
    ActionChains(browser).move_to_element(canvas).perform()
    wait(browser, "return arguments[0].querySelector('.readout').textContent.length > 5", figure)
    text = element(browser, f"{ANSWER} .readout").text
    assert ", threshold 0.6, false" in text


def test_light_and_dark(opened):
    browser = opened(mission())
    drawn(browser, ANSWER)
    colour = "return getComputedStyle(document.body).backgroundColor"
    assert browser.execute_script(colour) == "rgb(247, 248, 249)"
    axis = "return Object.values(Bokeh.index)[0].model.children[0].left[0].major_label_text_color"
    light = browser.execute_script(axis)
    button = element(browser, "#theme")
    assert button.text == "Dark"
    button.click()
    assert browser.execute_script(colour) == "rgb(16, 18, 21)"
    assert browser.execute_script(axis) != light
    assert button.text == "Light"
    button.click()
    assert browser.execute_script(axis) == light


def test_a_machine_that_is_dark_gets_a_dark_page(opened, browser):
    dark = [{"name": "prefers-color-scheme", "value": "dark"}]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": dark})
    try:
        opened(mission())
        colour = "return getComputedStyle(document.body).backgroundColor"
        assert browser.execute_script(colour) == "rgb(16, 18, 21)"
    finally:
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def test_paper_gets_all_that_is_folded_and_the_figures_that_stand_still(opened):
    browser = opened(mission())
    drawn(browser, ANSWER)
    folded = "return document.querySelectorAll('details:not([open])').length"
    before = browser.execute_script(folded)
    assert before > 0
    browser.execute_script(
        "addEventListener('beforeprint', () => { window.atPrint = ["
        "document.querySelectorAll('details:not([open])').length,"
        "getComputedStyle(document.querySelector('.lead .still')).display] })"
    )
    pdf = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", {})["data"])
    assert pdf.startswith(b"%PDF-")
    assert pdf.count(b"/Type /Page\n") >= 3
    assert browser.execute_script("return window.atPrint")[0] == 0
    assert browser.execute_script(folded) == before


def test_a_link_unfolds_what_it_leads_to(opened):
    browser = opened(mission())
    assert not element(browser, "#m1-2-1 .why").is_displayed()
    browser.execute_script("location.hash = '#m1-2-1'")
    wait(browser, "return document.getElementById('m1-2').open")
    assert element(browser, "#m1-2-1 .why").is_displayed()


def test_without_a_script_everything_can_be_read(opened):
    browser = opened(mission(), script=False)
    assert "none of the parameters" in element(browser, ".answer .claim").text
    assert element(browser, f"{ANSWER} .still svg").is_displayed()
    assert element(browser, f"{TIMELINE} .still svg").is_displayed()
    element(browser, "#m1-1 > summary").click()
    assert len(visible(browser, ROWS)) == 12
    assert not element(browser, "#theme").is_displayed()


def elements(browser):
    """How many there are of each kind of element, shadow trees left out."""
    return browser.execute_script(
        "const n = {}; for (const e of document.querySelectorAll('body *:not(.figure *)'))"
        " n[e.localName] = (n[e.localName] || 0) + 1; return n"
    )


def test_hostile_names_stay_text(opened):
    browser = opened(accused(names=("aaa", "bbb", "ccc")))
    harmless = elements(browser)
    for start in range(0, len(HOSTILE), 3):
        names = tuple(HOSTILE[(start + n) % len(HOSTILE)] for n in range(3))
        opened(accused(names=names, name=names[0], treatment=names[1], changed_parameter=names[1]))
        for figure in (ANSWER, TIMELINE):
            drawn(browser, figure)
        found = elements(browser)
        # The changed parameter has a sign, and a line of its positions has more text.
        for kind in ("script", "img", "b", "a", "iframe", "style", "code", "tr", "button"):
            assert found.get(kind, 0) == harmless.get(kind, 0), (names, kind)
        inline = "return document.querySelectorAll('[onerror], [onmouseover], [onclick]').length"
        assert browser.execute_script(inline) == 0
        first = names[1].splitlines()[0].split("\u2028")[0].strip()
        if first.isprintable():
            assert first in element(browser, ".answer .claim").text
    with pytest.raises(Exception, match="no such alert"):
        _ = browser.switch_to.alert.text


# 50,000 evaluations in a figure: it is drawn of extremes, and a wild value between is not lost.
def test_many_points_are_thinned_and_extremes_kept(opened):
    rows = [(step / 1000, 0, False, 1 + step % 2, 3) for step in range(50_000)]
    rows[33_333] = (33.333, 0, True, 3.5, 3)
    recording = Recording("many", events(rows), (Mark(ns(49), "II"),), 0, ns(50))
    static = static_info(comparison(0, "x"), comparison(1, "y"))
    browser = opened(MissionReport("many", recording, static, rank_marks(recording, static)))
    figure = drawn(browser, ANSWER)
    for _ in range(2):
        figure.send_keys("-")
    wait(
        browser,
        "const shown = Object.values(Bokeh.index).find((view) => arguments[0].contains(view.el));"
        "const y = shown.model.children[0].renderers[0].data_source.data.y;"
        "return y.length > 100 && y.length < 5000 && Math.max(...y.filter(Number.isFinite)) == 3.5",
        figure,
    )


@pytest.mark.parametrize("width", [400, 1280])
def test_long_names_are_folded(opened, browser, width):
    names = tuple(letter * 300 for letter in "abc")
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        opened(accused(names=names, name=names[0], treatment=names[1], changed_parameter=names[1]))
        for figure in (ANSWER, TIMELINE):
            drawn(browser, figure)
        assert browser.execute_script("return document.documentElement.scrollWidth") <= width
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


# The README's picture: the whole answer, from the page of the demo.
def test_the_picture_of_an_answer(tmp_path):
    page, picture = tmp_path / "report.html", tmp_path / "answer.png"
    tool = Path(__file__).parents[2] / "tools" / "draw-answer"
    write_missions(page, [mission(name="none"), accused(name="it")])
    done = subprocess.run([tool, page, "-o", picture], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    height, width, *_ = matplotlib.image.imread(picture).shape
    assert width > 900
    assert height > 600
    done = subprocess.run([tool, page, "none?"], capture_output=True, text=True, check=False)
    assert (done.returncode, "no none?" in done.stderr) == (1, True)
