"""Speaks to a running graph: graphs, recorders, marks, live settings."""
