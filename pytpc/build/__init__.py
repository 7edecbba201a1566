"""Builds a workspace with TPC and gathers what the analysis found."""
