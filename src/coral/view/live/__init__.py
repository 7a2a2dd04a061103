"""A browser page that shows a running mission, or replays a recorded one."""
