"""Whole conditions from the syntax trees, and what show, the page and SARIF say of a TPC."""
