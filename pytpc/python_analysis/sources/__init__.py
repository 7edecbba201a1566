"""Which scripts of a workspace are nodes, and the text of their modules."""
