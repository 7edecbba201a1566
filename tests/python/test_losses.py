"""Messages that went missing, by their numbers."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recorded_messages import log

from pytpc.ingest.losses import LossCounter
from pytpc.ros.ros1.relay import Relay


def test_loss_counter_counts_the_numbers_that_are_missing():
    counter = LossCounter()
    # /a: 0 1 2 | 5: two are missing (3, 4) | 6. /b begins at 4: 1 to 3 were sent before.
    for node, number in [("/a", 0), ("/a", 1), ("/b", 4), ("/a", 2), ("/a", 5), ("/b", 5)]:
        counter.see(node, number)
    counter.see("/a", 6)
    assert counter.lost == Counter({"/a": 2})
    assert counter.missed_before == Counter({"/b": 3})


def test_loss_counter_spares_the_number_that_rosout_got_of_a_latched_sender():
    # 1 | 3: rosout came after 1, and was sent it again as 2. 3 | 5: 4 is missing. /b: no latch.
    counter = LossCounter()
    for number in (1, 3, 5):
        counter.see("/a", number, latched=True)
    for number in (1, 3):
        counter.see("/b", number)
    assert counter.lost == Counter({"/a": 1, "/b": 1})


def test_loss_counter_spares_no_larger_gap():
    # 1 | 4: 2 and 3 are missing, and only one of them can have gone to rosout.
    counter = LossCounter()
    for number in (1, 4):
        counter.see("/a", number, latched=True)
    assert counter.lost == Counter({"/a": 2})


def test_loss_counter_takes_a_restarted_node_for_a_new_beginning():
    counter = LossCounter()
    for number in (8, 9, 0, 1):
        counter.see("/a", number)
    assert counter.lost == Counter()


@given(
    st.lists(st.tuples(st.sampled_from(["/a", "/b"]), st.integers(0, 9)), min_size=1),
    st.integers(0, 50),
)
def test_many_messages_at_once_are_counted_as_one_by_one(messages, cut):
    one_by_one, at_once = LossCounter(), LossCounter()
    for node, number in messages:
        one_by_one.see(node, number, latched=node == "/a")
    for part in (messages[:cut], messages[cut:]):
        numbers = np.array([number for _, number in part], np.int64)
        at_once.see_all([node for node, _ in part], numbers, {"/a"})
    assert (at_once.lost, at_once.missed_before) == (one_by_one.lost, one_by_one.missed_before)


def test_who_replays_a_bag_numbers_anew():
    relay = Relay(pytest.fail)
    for number, node in enumerate([b"/a", b"/b", b"/b", b"/a"]):
        relay.take(log(node, number), "/play")
    relay.take(log(b"/b", 9), "/play")
    assert relay.lost == 5


def batch(seq: int, count: int, pid: int = 1) -> bytes:
    return f"#seq:{seq},count:{count},dropped:0,pid:{pid},steady:1.0\n1.5,...".encode()


# /a's process 1 begins with 3: 0 to 2 were sent before. 3 4 | 7 8 9: two are missing. Process 2 is
# /a started again. A message of one line has no number.
def test_batches_that_are_missing_are_counted():
    counter = LossCounter()
    seen = [counter.see_text("/a", batch(3, 2)), counter.see_text("/a", batch(7, 3))]
    seen += [counter.see_text("/a", batch(0, 4, pid=2)), counter.see_text("/a", batch(4, 1, pid=2))]
    assert seen == [2, 3, 4, 1]
    assert counter.see_text("/b", b"1.5,k") == 1
    assert counter.see_text("/b", b"#seq:x") == 0
    assert (counter.lost, counter.missed_before) == (Counter({"/a": 2}), Counter({"/a": 3}))
