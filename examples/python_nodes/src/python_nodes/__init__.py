"""What several nodes of the suite share."""
