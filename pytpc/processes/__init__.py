"""What a process is: an executable, the libraries that it needs and the plugins that it loads."""
