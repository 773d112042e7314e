"""The live view: a simulation that keys command, and the window that shows it."""
