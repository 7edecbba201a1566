"""The suite of nodes, examples/threshold_nodes: what is expected of each, and how it is judged."""
