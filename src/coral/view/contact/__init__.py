"""Pictures, charts, report and video of a contact episode."""
