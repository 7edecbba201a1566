"""Python nodes: from the source of a script and its modules to a link unit."""
