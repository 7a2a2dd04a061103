"""Every limit on bytes that come from elsewhere: files, archives, pictures, logs. `coral.foreign_file` enforces them.

A refused file costs less than 500 MB of memory and five seconds.
"""

from __future__ import annotations

YAML_BYTES = 20_000_000
"""Of a YAML file: fifty times the largest shipped world."""
YAML_VALUES = 500_000
"""Values in a YAML file, aliases expanded: 100 000 oysters."""
YAML_DEPTH = 50
"""Nesting in YAML. PyYAML's C parser is recursive: 15 000 levels end the process by a signal."""
JSON_BYTES = 100_000_000
"""Of a JSON file: the answers recorded for hundreds of long missions."""
JSON_DEPTH = 60
"""Nesting in JSON. Python's own functions on values fail at some hundreds."""
TABLE_BYTES = 100_000_000
"""Of a table of poses: eleven days at one a second."""
LOG_BYTES = 200_000_000
"""Of a log; a report leaves out the rest."""
AUTOPILOT_LOG_BYTES = 1_000_000_000
"""Of an autopilot's log: a day's .BIN. It is read through a window, not into memory."""
AUTOPILOT_SAMPLES = 1_000_000
"""Poses, attitudes and ranges that are kept of it: nine hours."""
VIDEO_PICTURES = 100_000
"""Taken out of a video: five hours at 5 Hz."""
VIDEO_S = 7200
"""For decoding a video (s)."""
LINE_CHARS = 16_000_000
"""Of one line of a log: a question with all its facts has some hundred thousand."""
PICTURE_BYTES = 100_000_000
"""Of a picture file: 60 megapixels without compression are less."""
PICTURE_PIXELS = 64_000_000
"""Of a picture before it is decoded: no underwater camera has more, and in colour they take 200 MB."""
ARRAYS_BYTES = 200_000_000
"""Of the unpacked arrays of an .npz file: the map of a survey of 500 x 500 m."""
MESH_BYTES = 100_000_000
"""Of a mesh: a million triangles as text."""
CHUNK_BYTES = 100_000_000
"""Of an unpacked chunk of an MCAP file: `ros2 bag` writes less than one, whatever its pictures."""
ROW_BYTES = 10_000_000
"""Of one value in an SQLite file: an experience has some ten thousand."""
LARGEST_NUMBER = 1e9
"""In tables, events and metrics: metres, seconds and counts of missions stay far below; 1e300 makes a chart or a map
that no machine holds."""
LATEST_S = 1e10
"""Of a time stamp that may be Unix time (s)."""
