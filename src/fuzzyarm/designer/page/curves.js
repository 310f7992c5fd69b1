// The curves of a run over time.

import { stage as canvasStage } from "./charts.js";
import { el, pane, shortNumber, colourOf, ticks, hue } from "./draw.js";
import { S } from "./strings.js";

const LEGEND = 18; // above each panel, px

/**
 * Panels over time: what is followed with its reference, errors, and the drives of each unit.
 *
 * @param {Page.Store} store
 */
export function curvePane(store) {
  const { section, bar, body } = pane("run-curves", S.runCurves);
  const { canvas, redraw } = canvasStage(store, body, draw);
  const key = el("span", { class: "key" });
  let panels = [];
  let ready = null;
  let t = [];
  let low = [];
  let high = [];
  bar.append(el("span", { class: "space" }), key);
  canvas.setAttribute("aria-label", S.runCurvesLabel);

  /** Outputs with their references, errors, and the drives of each unit. */
  function open(news) {
    ready = news;
    const count = news.tracked.length;
    const units = [...new Set(news.tracked.map((each) => each.unit))];
    panels = units.flatMap((unit) => {
      const own = news.tracked.map((each, i) => ({ ...each, i })).filter((each) => each.unit === unit);
      return [
        {
          title: S.runOutputs,
          unit,
          lines: own.flatMap(({ name, i }) => [
            { name: "", column: i, colour: null }, // reference
            { name, column: count + i, colour: i },
          ]),
        },
        { title: S.runError, unit, lines: own.map(({ name, i }) => ({ name, column: 2 * count + i, colour: i })) },
      ];
    });
    const drives = news.drives.map((each, i) => ({ ...each, column: 3 * count + i, colour: i }));
    for (const unit of new Set(drives.map((each) => each.unit))) {
      panels.push({ title: S.runDrives, unit, lines: drives.filter((each) => each.unit === unit) });
    }
    t = [];
    low = Array.from({ length: 3 * count + drives.length }, () => []);
    high = low.map(() => []);
    redraw();
  }

  function add(news) {
    // A run that begins again begins at 0.
    t.push(...news.t);
    news.low.forEach((column, k) => {
      low[k].push(...column);
      high[k].push(...(news.high ?? news.low)[k]);
    });
    // What has left the window goes, now and then.
    const first = t[t.length - 1] - ready.window;
    if (t[0] < first - 0.5 * ready.window) {
      const gone = t.findIndex((each) => each >= first);
      for (const each of [t, ...low, ...high]) each.splice(0, gone);
    }
    redraw();
  }

  function draw({ g, width, height }) {
    if (!ready) return;
    const last = t[t.length - 1] ?? 0;
    const end = Math.max(ready.window, last);
    const [begin, foot, gap] = [end - ready.window, 18, 6];
    const each = (height - foot) / panels.length;
    const [left, right] = [52, width - 16];
    const x = (time) => left + ((time - begin) / ready.window) * (right - left);
    g.font = "11px system-ui, sans-serif";
    const first = Math.max(0, t.findIndex((time) => time >= begin) - 1);
    panels.forEach((panel, p) => drawPanel(g, panel, [left, right, p * each + LEGEND, (p + 1) * each - gap], x, first));
    g.fillStyle = colourOf("--soft");
    g.textAlign = "center";
    for (const tick of ticks(begin, end, width / 90)) g.fillText(`${shortNumber(tick)} s`, x(tick), height - 4);
  }

  function drawPanel(g, panel, [left, right, top, bottom], x, first) {
    const soft = colourOf("--soft");
    const [from, to] = span(panel, first);
    const y = (value) => bottom - ((value - from) / (to - from)) * (bottom - top);
    g.save();
    g.strokeStyle = colourOf("--line");
    g.lineWidth = 1;
    g.textAlign = "right";
    g.fillStyle = soft;
    for (const tick of ticks(from, to, Math.max(3, (bottom - top) / 24))) {
      g.beginPath();
      g.moveTo(left, y(tick));
      g.lineTo(right, y(tick));
      g.stroke();
      g.fillText(shortNumber(tick), left - 5, y(tick) + 4);
    }
    g.beginPath();
    g.rect(left, top - 2, right - left, bottom - top + 4);
    g.clip();
    for (const { low: floor, high: ceiling } of panel.lines) {
      for (const limit of [floor, ceiling]) {
        if (limit === null || limit === undefined) continue;
        stroke(g, colourOf("--lit"), 1, [5, 4], () => {
          g.moveTo(left, y(limit));
          g.lineTo(right, y(limit));
        });
      }
    }
    for (const line of panel.lines) {
      const reference = line.colour === null;
      const tint = reference ? soft : tone(line.colour);
      stroke(g, tint, reference ? 1.2 : 1.7, reference ? [4, 3] : [], () => curve(g, line.column, x, y, first));
    }
    g.restore();
    g.textAlign = "left";
    let at = left;
    for (const [words, tint] of [
      [`${panel.title}${panel.unit && panel.unit !== "1" ? `, ${panel.unit}` : ""}:`, soft],
      ...panel.lines.filter((line) => line.name).map((line) => [line.name, tone(line.colour)]),
    ]) {
      g.fillStyle = tint;
      g.fillText(words, at, top - 5);
      at += g.measureText(words).width + 8;
    }
  }

  /** The colours of lines: those of terms, as a canvas takes them. */
  function tone(index) {
    const probe = key;
    probe.style.color = hue(index);
    return getComputedStyle(probe).color;
  }

  function stroke(g, tint, width, dashes, way) {
    g.strokeStyle = tint;
    g.lineWidth = width;
    g.setLineDash(dashes);
    g.beginPath();
    way();
    g.stroke();
    g.setLineDash([]);
  }

  function curve(g, column, x, y, first) {
    let before = false;
    for (let i = first; i < t.length; i++) {
      const [a, b] = [low[column][i], high[column][i]];
      if (a === null || b === null) {
        before = false;
        continue;
      }
      const px = x(t[i]);
      if (before) g.lineTo(px, y(b));
      else g.moveTo(px, y(b));
      if (a !== b) g.lineTo(px, y(a));
      before = true;
    }
  }

  /** Between what a panel goes: what is seen, and the limits. */
  function span(panel, first) {
    let [from, to] = [Infinity, -Infinity];
    const take = (value) => {
      if (value === null || value === undefined) return;
      from = Math.min(from, value);
      to = Math.max(to, value);
    };
    for (const line of panel.lines) {
      for (let i = first; i < t.length; i++) {
        take(low[line.column][i]);
        take(high[line.column][i]);
      }
      take(line.low);
      take(line.high);
    }
    if (!(to >= from)) return [-1, 1];
    if (to - from < 1e-9 * Math.max(1, Math.abs(to))) return [from - 1, to + 1];
    const room = 0.08 * (to - from);
    return [from - room, to + room];
  }

  return { section, open, add };
}
