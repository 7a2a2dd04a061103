"""Pictures, charts, report and film of a contact episode."""
