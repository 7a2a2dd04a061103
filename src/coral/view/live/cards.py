"""HTML of the live page's texts and numbers."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from coral.view.live.state import Answered, Asked, LiveState
from coral.view.pictures import RGB
from coral.view.svg import clock

TONES = {"plain": "inherit", "good": "#0a7d4f", "bad": "#c8352b"}
VERDICTS = {
    "accepted": "#0a7d4f",
    "rejected": "#c8352b",
    "malformed": "#c8352b",
    "unavailable": "#c8352b",
    "withdrawn": "#5d6b7a",
}
BOX = "padding:8px 10px;border-radius:6px;border:1px solid rgba(128,140,155,.35);margin:0 0 8px 0;"
SMALL = "font-size:11px;opacity:.72;"


def head(state: LiveState) -> str:
    """Render title, status, simulated time and the numbers."""
    tone = "#5d6b7a" if state.status.startswith("ended") else "#b26a00" if state.status == "paused" else "#0b6470"
    until = f" <span style='{SMALL}'>of {clock(state.until_s)}</span>" if state.until_s else ""
    tiles = "".join(
        f"<div style='min-width:0'><div style='{SMALL}'>{escape(n.name)}</div>"
        f"<div style='font-size:15px;font-weight:650;color:{TONES[n.tone]};white-space:nowrap'>{escape(n.value)}</div>"
        "</div>"
        for n in state.numbers
    )
    return (
        "<div style='padding:4px 12px 8px 12px;line-height:1.35'>"
        f"<div style='font-size:17px;font-weight:700'>{escape(state.title)}</div>"
        f"<div style='{SMALL}'>{escape(state.about)}</div>"
        "<div style='display:flex;justify-content:space-between;align-items:baseline;margin:8px 0 6px 0'>"
        f"<div><span style='font-size:22px;font-weight:700'>{clock(state.t)}</span>"
        f"{until} <span style='{SMALL}'>simulated</span></div>"
        f"<div id='status' style='color:white;background:{tone};border-radius:10px;padding:1px 9px;font-size:12px'>"
        f"{escape(state.status)}</div></div>"
        f"<div style='display:grid;grid-template-columns:repeat(3,1fr);gap:6px 8px'>{tiles}</div></div>"
    )


def decision(state: LiveState) -> str:
    """Render the open question, and the last verdict with its reason."""
    return (
        f"<div style='padding:2px 12px;line-height:1.4;font-size:13px'>{_question_html(state.asked, state.t)}"
        f"{_verdict_html(state.answered)}</div>"
    )


def _question_html(asked: Asked | None, t: float) -> str:
    if asked is None:
        return f"<div style='{BOX}opacity:.75'><b>No open question</b></div>"
    again = f", attempt {asked.attempt + 1}" if asked.attempt else ""
    cause = f"<div style='{SMALL}'>because {escape(asked.cause)}</div>" if asked.cause else ""
    return (
        f"<div style='{BOX}border-left:4px solid #b26a00'><div style='{SMALL}'>OPEN QUESTION</div>"
        f"<b>{escape(asked.title)}</b> <span style='opacity:.8'>({escape(asked.mode)} mode{again})</span>"
        f"<div>open since {clock(asked.since_s)}, for {max(t - asked.since_s, 0.0):.0f} s</div>{cause}</div>"
    )


def _verdict_html(answered: Answered | None) -> str:
    if answered is None:
        return ""
    color = VERDICTS.get(answered.verdict, "#5d6b7a")
    reason = f"<div style='{SMALL}'>{escape(answered.reason)}</div>" if answered.reason else ""
    return (
        f"<div style='{BOX}border-left:4px solid {color}'><div style='{SMALL}'>LAST VERDICT, "
        f"{clock(answered.at_s)}</div><b style='color:{color}'>{escape(answered.verdict)}</b>: "
        f"{escape(answered.said)}{reason}</div>"
    )


def log(state: LiveState) -> str:
    """Render the latest events."""
    rows = "".join(f"<div style='opacity:{1 - 0.08 * k:.2f}'>{escape(line)}</div>" for k, line in enumerate(state.log))
    return f"<div style='padding:0 12px;font-size:12px;line-height:1.45'>{rows}</div>"


def legend(state: LiveState) -> str:
    """Render the meaning of the colours."""
    note = f"<div style='{SMALL}padding:4px 12px 0 12px'>{escape(state.note)}</div>" if state.note else ""
    return keys(state.legend) + note


def keys(entries: Iterable[tuple[RGB, str]]) -> str:
    """Render colours with their names."""
    row = "".join(f"<span style='white-space:nowrap'>{_swatch(color)}{escape(name)}</span>" for color, name in entries)
    return f"<div style='padding:0 12px;font-size:12px;display:flex;flex-wrap:wrap;gap:2px 12px'>{row}</div>"


def _swatch(color: RGB) -> str:
    return (
        f"<span style='display:inline-block;width:10px;height:10px;border-radius:2px;margin-right:5px;"
        f"border:1px solid rgba(128,140,155,.5);background:rgb{color}'></span>"
    )
