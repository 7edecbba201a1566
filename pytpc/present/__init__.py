"""Answers as text, JSON, screens and pages. Computes nothing."""
