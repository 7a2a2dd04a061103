"""A page in the browser that shows a mission while it runs, or a recorded one again."""
