"""The live page: a browser view of a running mission or of a recorded one."""
