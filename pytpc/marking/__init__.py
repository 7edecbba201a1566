"""An observer's keys become marks: on a live graph, beside a replay, on a recording."""
