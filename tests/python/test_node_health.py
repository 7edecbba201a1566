"""What `pytpc stream --diagnostics` says of each node: rates, drops, silence, settings."""

from __future__ import annotations

from typing import Any

from pytpc.api.node_health import NodeHealth, suspects_status
from pytpc.ros.diagnostic_messages import DiagnosticStatus, Level
from pytpc.ros.node_status import NodeStatus


def status(health: NodeHealth, now_s: float) -> DiagnosticStatus:
    (found,) = health.statuses(now_s)
    return found


def settings(success: bool = True, message: str = "", **values: Any) -> dict[str, NodeStatus]:
    return {
        "/guard": NodeStatus("/guard", success, message, {k: str(v) for k, v in values.items()})
    }


def reporting(seconds: int = 10) -> NodeHealth:
    """A node that sends two reports of five evaluations each second."""
    health = NodeHealth()
    for half in range(2 * seconds):
        health.see("/guard", 5, half / 2)
    return health


def test_rates_are_those_of_the_last_five_seconds():
    # From 4.6 to 9.6 s: ten reports of five evaluations.
    found = status(reporting(), 9.6)
    assert (found.name, found.level) == ("tpc: guard", Level.OK)
    values = dict(found.values)
    assert values["reports per second"] == "2.0"
    assert values["evaluations per second"] == "10.0"
    assert values["budget used"] == "no cap"


def test_a_part_of_the_cap_is_used():
    health = reporting()
    health.tell_settings(settings(process_cap=50, sink="auto", policy="light"), 9.0)
    values = dict(status(health, 9.6).values)
    assert values["budget used"] == "4 %"
    assert (values["sink"], values["policy"]) == ("auto", "light")


def test_drops_warn_for_half_a_minute():
    health = reporting(60)
    health.tell_dropped({("/guard", "site"): 3, ("/guard", "process"): 4}, 20.0)
    found = status(health, 49.9)
    assert (found.level, found.message) == (Level.WARN, "7 reports dropped")
    assert dict(found.values)["dropped since we listen, by reason"] == "process: 4, site: 3"
    # The same count again is nothing new.
    health.tell_dropped({("/guard", "site"): 3, ("/guard", "process"): 4}, 45.0)
    assert status(health, 50.1).level is Level.OK


# An hour ago 7 reports were dropped; then one more, of which the node tells only by its settings.
def test_what_was_dropped_before_we_listened_is_no_warning():
    health = reporting()
    health.tell_settings(settings(dropped=7), 9.0)
    found = status(health, 9.6)
    assert (found.level, dict(found.values)["reports dropped"]) == (Level.OK, "7")
    # The same settings are told each second, until the node is asked again.
    health.tell_settings(settings(dropped=8), 9.8)
    health.tell_settings(settings(dropped=8), 9.9)
    found = status(health, 10.0)
    assert (found.level, found.message) == (Level.WARN, "8 reports dropped")


# What its reports say is new, though it is less than what the node has dropped since its start.
def test_drops_that_reports_tell_warn_beside_what_the_settings_say():
    health = reporting()
    health.tell_settings(settings(dropped=100), 9.0)
    health.tell_dropped({("/guard", "site"): 3}, 9.2)
    assert status(health, 9.6).level is Level.WARN


def test_a_node_that_is_silent_is_stale():
    found = status(reporting(), 19.5)
    assert (found.level, found.message) == (Level.STALE, "no report for 10 s")
    assert dict(found.values)["reports per second"] == "0.0"


def test_settings_that_are_not_known_or_a_full_file_warn():
    health = reporting()
    health.tell_settings(settings(success=False, message="timed out"), 9.0)
    assert status(health, 9.6).message == "its settings are not known: timed out"
    health.tell_settings(settings(state="stopped"), 9.0)
    found = status(health, 9.6)
    assert found.level is Level.WARN
    assert found.message.startswith("its file is full")


def test_what_a_node_says_may_be_anything():
    health = reporting()
    health.tell_settings(settings(process_cap="-1e9", dropped="9" * 40), 9.0)
    values = dict(status(health, 9.6).values)
    assert (values["budget used"], values["reports dropped"]) == ("no cap", "0")


def test_the_number_of_nodes_is_bounded():
    health = NodeHealth()
    for number in range(250):
        health.see(f"/n{number}", 1, 1.0)
    assert len(health.statuses(1.0)) == 200
    assert health.left_out == 50


def test_the_suspects_before_a_mark_and_before_a_verdict():
    found = suspects_status(None, None, 0, "")
    assert (found.name, found.level, found.message) == ("tpc: suspects", Level.OK, "no mark yet")
    found = suspects_status(None, None, 2, "")
    assert (found.level, found.message) == (Level.WARN, "2 marks, not judged yet")
    found = suspects_status(None, None, 0, "the master is gone")
    assert (found.level, dict(found.values)["fault"]) == (Level.WARN, "the master is gone")
