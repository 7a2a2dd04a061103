"""The pictures, report and video of a finished run."""

from __future__ import annotations

from pathlib import Path

from coral.run_files import TaskFiles


def render_run(folder: Path, *, report: bool, video: bool) -> dict[str, str]:
    """Make report (with map or key frames) and video of a mission or a task; return the files that people open."""
    # A command loads the system that it shows, not the other one.
    if (folder / TaskFiles.TASK).is_file():
        from coral.view.contact.report import write_contact_report as write_page
        from coral.view.contact.video import write_contact_video as write_film
    else:
        from coral.view.report import write_report as write_page
        from coral.view.video import write_video as write_film
    made = {}
    if video:
        made["video"] = str(write_film(folder))
    if report:  # last: it shows the video
        made["report"] = str(write_page(folder))
    return made
