"""Turns an Account into the text of one HTML page that needs nothing but a browser."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

from kreisel.files.extras import library
from kreisel.show.report import facts, lines
from kreisel.show.report.charts import Chart, charts_with, plots
from kreisel.show.report.palette import css_variables
from kreisel.show.report.space import space
from kreisel.study.account import Account

# In this order: each uses what those before it define.
_SCRIPTS = ("tracks.js", "scene.js", "charts.js", "page.js")

_COLUMNS = ("filter", "total", "heading", "inclin.", "largest", "below 5° after")


def page(account: Account) -> str:
    """The page of a run. Raises ValueError where there is nothing to show, and where Bokeh is not installed."""
    library("bokeh", "report", "a report")
    on = lines.timeline(account)
    data, charts = _data(account, on)
    return Template(_part("report.html")).substitute(
        title=escape(account.name or "recording"),
        colours=css_variables(),
        style=_part("report.css"),
        subtitle=escape(_subtitle(account, on)),
        imus=_options(reading.mount.name for reading in account.readings),
        filters=_options(dict.fromkeys(answer.filter for answer in account.answers)),
        errors=_errors(account),
        source="Scenario" if account.report else "Recording",
        facts=_rows(facts.facts(account, on)),
        notes="".join(f"<li>{escape(note)}</li>" for note in facts.notes(account)),
        keys=_keys(account),
        charts="\n".join(
            _section(chart, wide=k == 0 and len(charts) % 2 == 1) for k, chart in enumerate(charts)
        ),
        bokeh=_bokeh_script(),
        data=_json({**data, **_bokeh_documents(charts, on)}),
        script="\n".join(_part(name) for name in _SCRIPTS),
    )


def _data(account: Account, on: lines.Timeline) -> tuple[dict[str, Any], list[Chart]]:
    """What the scripts read, and the charts that it has lines for."""
    by_name = {reading.mount.name: reading for reading in account.readings}
    layers = {
        "motion": [lines.motion_layer(account, on)],
        "readings": [lines.reading_layer(account, reading, on) for reading in account.readings],
        "answers": [lines.answer_layer(account, by_name[a.imu], a, on) for a in account.answers],
    }
    charts = charts_with({name for several in layers.values() for layer in several for name in layer.lines})
    data: dict[str, Any] = {
        name: [{"lines": x.lines, "limits": x.limits, "beyond": x.beyond} for x in several]
        for name, several in layers.items()
    }
    for layer, answer in zip(data["answers"], account.answers, strict=True):
        layer |= {"imu": answer.imu, "filter": answer.filter}
    return {**data, "start": on.start, "end": on.end, "space": space(account, on)}, charts


def _bokeh_documents(charts: Sequence[Chart], on: lines.Timeline) -> dict[str, Any]:
    """The plots as BokehJS takes them, and the elements of the page they go into."""
    from bokeh.document import Document
    from bokeh.embed.util import standalone_docs_json_and_render_items

    document = Document()
    for plot in plots(list(charts), on.start, on.end):
        document.add_root(plot)
    found, (item,) = standalone_docs_json_and_render_items(document)
    roots = {root: f"plot-{chart.name}" for root, chart in zip(item.to_json()["roots"], charts, strict=True)}
    places = [{"docid": "charts", "roots": roots, "root_ids": list(roots)}]
    return _renumbered({"documents": {"charts": next(iter(found.values()))}, "places": places})


def _renumbered(made: dict[str, Any]) -> dict[str, Any]:
    """Bokeh counts its models through the life of the process; the same run is to give the same page."""
    text = json.dumps(made)
    ids = dict.fromkeys(re.findall(r'"(p\d{4,})"', text))
    new = {old: f'"m{k}"' for k, old in enumerate(ids)}
    renumbered: dict[str, Any] = json.loads(re.sub(r'"(p\d{4,})"', lambda found: new[found[1]], text))
    return renumbered


def _bokeh_script() -> str:
    from bokeh.resources import Resources

    # Of Bokeh's scripts the first is enough: no widgets, tables, formulas or WebGL.
    script = Resources(mode="inline", components=["bokeh"]).js_raw[0]
    return str(script).replace("</script", "<\\/script")


def _part(name: str) -> str:
    return (files("kreisel.show.report") / name).read_text(encoding="utf-8")


def _json(value: Any) -> str:
    """JSON that no name in it can end the element it stands in."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _subtitle(account: Account, on: lines.Timeline) -> str:
    kind = account.report.get("scenario", {}).get("trajectory", {}).get("kind", "recording")
    return f"{kind}, {on.end - on.start:.6g} s"


def _options(names: Iterable[str]) -> str:
    return "".join(f"<option>{escape(name)}</option>" for name in names)


def _rows(rows: Iterable[facts.Fact]) -> str:
    return "".join(
        f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}</td></tr>' for name, value in rows
    )


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    heads = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>" for row in rows)
    return f"<thead><tr>{heads}</tr></thead><tbody>{body}</tbody>"


def _errors(account: Account) -> str:
    if not account.answers or account.truth is None:
        return ""
    table = _table(_COLUMNS, facts.errors_table(account))
    head = "<h2>Attitude errors: RMSE and largest, deg</h2>"
    return f'{head}<div class="scroll"><table id="errors">{table}</table></div>'


def _keys(account: Account) -> str:
    if not account.report:
        return ""
    rows = _rows(facts.every_key(account.report["scenario"]))
    return f'<details><summary>every key</summary><table class="facts keys"><tbody>{rows}</tbody></table></details>'


def _section(chart: Chart, wide: bool) -> str:
    """The element of a chart: its title, its legend, its plot."""
    entries = {trace.entry: trace for trace in chart.traces}
    # What is compared with comes last, though it is drawn first.
    ordered = sorted(entries.values(), key=lambda trace: trace.broad)
    buttons = "".join(_entry(trace.entry, trace.colour, trace.broad) for trace in ordered)
    return (
        f'<section class="chart{" wide" if wide else ""}" data-chart="{chart.name}" aria-label="{escape(chart.title)}">'
        f'<header><h2>{escape(chart.title)}</h2><div class="legend">{buttons}</div></header>'
        f'<div class="plot" id="plot-{chart.name}"></div><p class="remark" hidden></p></section>'
    )


def _entry(entry: str, colour: str, broad: bool) -> str:
    look = (
        f'class="swatch{" broad" if broad else ""}" style="--colour: var(--{"faint" if broad else colour})"'
    )
    value = "" if broad else "<output></output>"
    return (
        f'<button type="button" aria-pressed="true" data-entry="{escape(entry)}" title="show or hide {escape(entry)}">'
        f"<i {look}></i>{escape(entry)}{value}</button>"
    )
