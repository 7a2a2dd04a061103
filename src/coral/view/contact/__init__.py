"""What people look at of a contact episode: pictures, charts, report, film."""
