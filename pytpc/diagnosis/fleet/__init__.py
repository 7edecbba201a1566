"""From digests of many missions to answers about a fleet of robots."""
