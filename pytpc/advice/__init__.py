"""What to do with a suspect: suggestions of SPEC 8, and what they would have changed."""
