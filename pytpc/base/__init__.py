"""What every room needs: errors, files written atomically, columns, tables, checked JSON, paths."""
