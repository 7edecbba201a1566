"""The page of `pytpc live` over HTTP: the only room that listens for people."""
