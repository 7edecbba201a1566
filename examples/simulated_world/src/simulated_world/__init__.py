"""What the scripted observers of the examples share."""
