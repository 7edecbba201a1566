"""What every room needs: errors, files written atomically, columns, checked JSON, paths."""
