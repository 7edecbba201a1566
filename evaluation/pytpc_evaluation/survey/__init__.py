"""Builds source trees with and without TPC, and tables of that."""
