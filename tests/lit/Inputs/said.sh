# Says that a command is run, and runs it.
echo Linked
exec "$@"
