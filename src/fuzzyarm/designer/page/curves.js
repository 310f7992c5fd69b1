// The curves of a run over time.

import { stage as canvasStage } from "./charts.js";
import { el, pane, shortNumber, colourOf, hue } from "./draw.js";
import { ticks } from "./geometry/chart.js";
import { S } from "./strings.js";

const LEGEND = 18; // above each panel, px

/**
 * Panels over time: what is followed with its reference, errors, and the drives of each unit.
 *
 * @param {Page.Store} store
 */
export function curvePane(store) {
  return new CurvePane(store).api();
}

class CurvePane {
  /**
   * @param {Page.Store} store
   */
  constructor(store) {
    const { section, bar, body } = pane("run-curves", S.runCurves);
    this.section = section;
    const { canvas, redraw } = canvasStage(store, body, this.draw);
    this.redraw = redraw;
    this.key = el("span", { class: "key" });
    this.panels = [];
    this.ready = null;
    this.t = [];
    this.low = [];
    this.high = [];
    bar.append(el("span", { class: "space" }), this.key);
    canvas.setAttribute("aria-label", S.runCurvesLabel);
  }

  api() {
    return { section: this.section, open: this.open, add: this.add };
  }

  /** Outputs with their references, errors, and the drives of each unit. */
  open = (news) => {
    this.ready = news;
    const count = news.tracked.length;
    const units = [...new Set(news.tracked.map((each) => each.unit))];
    this.panels = units.flatMap((unit) => {
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
      this.panels.push({ title: S.runDrives, unit, lines: drives.filter((each) => each.unit === unit) });
    }
    this.t = [];
    this.low = Array.from({ length: 3 * count + drives.length }, () => []);
    this.high = this.low.map(() => []);
    this.redraw();
  };

  add = (news) => {
    // A run that begins again begins at 0.
    this.t.push(...news.t);
    news.low.forEach((column, k) => {
      this.low[k].push(...column);
      this.high[k].push(...(news.high ?? news.low)[k]);
    });
    // What has left the window goes, now and then.
    const first = this.t[this.t.length - 1] - this.ready.window;
    if (this.t[0] < first - 0.5 * this.ready.window) {
      const gone = this.t.findIndex((each) => each >= first);
      for (const each of [this.t, ...this.low, ...this.high]) each.splice(0, gone);
    }
    this.redraw();
  };

  draw = ({ g, width, height }) => {
    if (!this.ready) return;
    const last = this.t[this.t.length - 1] ?? 0;
    const end = Math.max(this.ready.window, last);
    const [begin, foot, gap] = [end - this.ready.window, 18, 6];
    const each = (height - foot) / this.panels.length;
    const [left, right] = [52, width - 16];
    const x = (time) => left + ((time - begin) / this.ready.window) * (right - left);
    g.font = "11px system-ui, sans-serif";
    const first = Math.max(0, this.t.findIndex((time) => time >= begin) - 1);
    this.panels.forEach((panel, p) =>
      this.drawPanel(g, panel, [left, right, p * each + LEGEND, (p + 1) * each - gap], x, first),
    );
    g.fillStyle = colourOf("--soft");
    g.textAlign = "center";
    for (const tick of ticks(begin, end, width / 90)) g.fillText(`${shortNumber(tick)} s`, x(tick), height - 4);
  };

  drawPanel = (g, panel, [left, right, top, bottom], x, first) => {
    const soft = colourOf("--soft");
    const [from, to] = this.span(panel, first);
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
        this.stroke(g, colourOf("--lit"), 1, [5, 4], () => {
          g.moveTo(left, y(limit));
          g.lineTo(right, y(limit));
        });
      }
    }
    for (const line of panel.lines) {
      const reference = line.colour === null;
      const tint = reference ? soft : this.tone(line.colour);
      this.stroke(g, tint, reference ? 1.2 : 1.7, reference ? [4, 3] : [], () =>
        this.curve(g, line.column, x, y, first),
      );
    }
    g.restore();
    g.textAlign = "left";
    let at = left;
    for (const [words, tint] of [
      [`${panel.title}${panel.unit && panel.unit !== "1" ? `, ${panel.unit}` : ""}:`, soft],
      ...panel.lines.filter((line) => line.name).map((line) => [line.name, this.tone(line.colour)]),
    ]) {
      g.fillStyle = tint;
      g.fillText(words, at, top - 5);
      at += g.measureText(words).width + 8;
    }
  };

  /** The colours of lines: those of terms, as a canvas takes them. */
  tone = (index) => {
    const probe = this.key;
    probe.style.color = hue(index);
    return getComputedStyle(probe).color;
  };

  stroke = (g, tint, width, dashes, way) => {
    g.strokeStyle = tint;
    g.lineWidth = width;
    g.setLineDash(dashes);
    g.beginPath();
    way();
    g.stroke();
    g.setLineDash([]);
  };

  curve = (g, column, x, y, first) => {
    let before = false;
    for (let i = first; i < this.t.length; i++) {
      const [a, b] = [this.low[column][i], this.high[column][i]];
      if (a === null || b === null) {
        before = false;
        continue;
      }
      const px = x(this.t[i]);
      if (before) g.lineTo(px, y(b));
      else g.moveTo(px, y(b));
      if (a !== b) g.lineTo(px, y(a));
      before = true;
    }
  };

  /** Between what a panel goes: what is seen, and the limits. */
  span = (panel, first) => {
    let [from, to] = [Infinity, -Infinity];
    const take = (value) => {
      if (value === null || value === undefined) return;
      from = Math.min(from, value);
      to = Math.max(to, value);
    };
    for (const line of panel.lines) {
      for (let i = first; i < this.t.length; i++) {
        take(this.low[line.column][i]);
        take(this.high[line.column][i]);
      }
      take(line.low);
      take(line.high);
    }
    if (!(to >= from)) return [-1, 1];
    if (to - from < 1e-9 * Math.max(1, Math.abs(to))) return [from - 1, to + 1];
    const room = 0.08 * (to - from);
    return [from - room, to + room];
  };
}
