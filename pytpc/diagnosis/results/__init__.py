"""What a diagnosis answers: plain data, which every room below may show."""
