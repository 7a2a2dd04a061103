"""The pictures, report and video of a finished run."""

from __future__ import annotations

from pathlib import Path


def render_survey(folder: Path, *, report: bool, video: bool) -> dict[str, str]:
    """Make map.png, report and video of a mission; return the files that people open."""
    made: dict[str, str] = {}
    if video:
        from coral.view.video import write_video

        made["video"] = str(write_video(folder))
    if report:  # last: it shows the video
        from coral.view.report import write_report
        from coral.view.runmap import write_map

        write_map(folder)
        made["report"] = str(write_report(folder))
    return made


def render_attempt(folder: Path, *, report: bool, video: bool) -> dict[str, str]:
    """Make key frames, report and video of a contact task; return the files that people open."""
    made: dict[str, str] = {}
    if video:
        from coral.view.contact.video import write_contact_video

        made["video"] = str(write_contact_video(folder))
    if report:
        from coral.view.contact.report import write_contact_report

        made["report"] = str(write_contact_report(folder))
    return made
