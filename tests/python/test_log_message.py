"""A log message of ROS 1 as it goes over the wire."""

from __future__ import annotations

import pytest
from recorded_messages import log

from pytpc.ingest.ros1 import decode_log


def test_a_log_message_has_its_text_behind_a_frame_name():
    assert decode_log(log(b"/a", 1, b"threshold_information:x", b"map")).msg == (
        b"threshold_information:x"
    )


@pytest.mark.parametrize("length", [0, 15, 17, 24, 30])
def test_a_message_that_is_no_log_is_an_error(length):
    with pytest.raises(ValueError, match=f"^a log message of {length} bytes ends too early$"):
        decode_log(log(b"/node", 1)[:length])
