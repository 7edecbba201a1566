"""The pages about a fleet in a real browser: Debian's chromium, without a window."""

from __future__ import annotations

import shutil
from dataclasses import replace

import pytest
from fleet_answers import (
    decision,
    drift,
    drifts,
    mission,
    outliers,
    ranking,
    setting,
    suspect,
    turn,
    value,
)
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By

from pytpc.diagnosis.results.fleet import DayMargin, FleetCause
from pytpc.present.fleet_page import (
    drifts_page,
    found_page,
    outliers_page,
    ranking_page,
    write_page,
)

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(
    CHROMIUM is None or DRIVER is None, reason="chromium and chromedriver are not installed"
)
LONG = "/a_namespace_of_this_robot/" + "and_a_name_without_any_place_to_break_it_" * 3
PHONE = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
WIDE = {"width": 1280, "height": 900, "deviceScaleFactor": 1, "mobile": False}


@pytest.fixture(scope="module")
def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    try:
        yield driver
    finally:
        driver.quit()


@pytest.fixture
def opened(browser, tmp_path):
    """Opens a page; afterwards nothing may have gone wrong, nor been forbidden by its policy."""

    def of(text, size):
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        path = tmp_path / "page.html"
        write_page(path, text)
        browser.get("about:blank")
        browser.get_log("browser")
        browser.get(path.as_uri())
        return browser

    yield of
    assert [entry for entry in browser.get_log("browser") if entry["level"] != "INFO"] == []


def pages():
    long = suspect(1, LONG, 0.4, values=(value(LONG, 3, 1, (LONG,)),), robots=(LONG,), reason=LONG)
    days = {"2026-11-01": 0.4, "2026-11-05": 0.3, "2026-11-10": 0.2}
    long_drift = drift(LONG, LONG, margins=tuple(map(DayMargin, days, days.values())))
    mixed = ranking(long, suspect(2, "~b", 0.1), notes=(LONG,))
    mixed = replace(mixed, causes=(FleetCause(LONG, 0.9, 3, (LONG,) * 20),) * 2)
    odd = replace(setting(LONG, LONG), value=LONG, usual=LONG)
    return {
        "ranking": ranking_page(mixed, LONG),
        "drifts": drifts_page(drifts(long_drift, drift()), LONG),
        "outliers": outliers_page(outliers((odd,), (decision(LONG, LONG), decision())), LONG),
        "found": found_page([(mission(LONG, LONG), [turn()]), (mission(), [])], LONG),
    }


@pytest.mark.parametrize("kind", ["ranking", "drifts", "outliers", "found"])
@pytest.mark.parametrize("size", [PHONE, WIDE], ids=["phone", "wide"])
def test_a_page_is_not_wider_than_its_window(opened, kind, size):
    browser = opened(pages()[kind], size)
    wide = "return document.documentElement.scrollWidth - document.documentElement.clientWidth"
    assert browser.execute_script(wide) == 0


def test_a_button_changes_the_theme(opened):
    browser = opened(pages()["ranking"], WIDE)
    colour = "return getComputedStyle(document.body).backgroundColor"
    before = browser.execute_script(colour)
    browser.find_element(By.ID, "theme").click()
    assert browser.execute_script(colour) != before


def test_a_link_opens_the_card_of_a_suspect(opened):
    browser = opened(pages()["ranking"], WIDE)
    card = browser.find_element(By.ID, "s2")
    assert card.get_attribute("open") is None
    browser.find_element(By.CSS_SELECTOR, "a[href='#s2']").click()
    assert card.get_attribute("open") is not None
