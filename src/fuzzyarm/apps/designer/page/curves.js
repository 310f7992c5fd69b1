// The curves of a run over time: what is followed with its reference, errors, and the drives of each unit.

import { colourOf, eachFrame, el, FONTS, hue, shortNumber } from "./draw.js";
import { valueRange } from "./geometry/chart.js";
import { Pane } from "./pane.js";
import { S } from "./strings.js";
import { uPlot } from "./vendor/uplot.js";

const LEGEND = 22; // above each plot, px
const TIMES = 26; // below the last plot, px
const VALUES = 56; // left of each plot, px

/** A plot for each unit, one above the other, with one time. */
export class CurvePane extends Pane {
  constructor(store) {
    super(store, null, "run-curves", S.runCurves);
    const { body } = this;
    this.host = el("div", { class: "plots", role: "group", "aria-label": S.runCurvesLabel });
    body.append(this.host);
    this.panels = [];
    this.plots = [];
    this.ready = null;
    // Over time, the least and the greatest value of every column since the sample before.
    this.t = [];
    this.low = [];
    this.high = [];
    this.redraw = eachFrame(this.draw);
    new ResizeObserver(this.resize).observe(body);
    store.on("theme", this.build); // a legend keeps the colours that it was made with
  }

  open = (news) => {
    this.ready = news;
    this.panels = panelsOf(news);
    this.t = [];
    this.low = Array.from({ length: 3 * news.tracked.length + news.drives.length }, () => []);
    this.high = this.low.map(() => []);
    this.build();
  };

  build = () => {
    for (const plot of this.plots) plot.destroy();
    this.plots = this.panels.map(this.plotOf);
    this.resize();
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
      const gone = this.t.findIndex((time) => time >= first);
      for (const column of [this.t, ...this.low, ...this.high]) column.splice(0, gone);
    }
    this.redraw();
  };

  draw = () => {
    this.plots.forEach((plot, p) => {
      // A line between the least and the greatest value of each sample: two series with a band.
      const columns = this.panels[p].lines.flatMap(({ column }) => [this.high[column], this.low[column]]);
      plot.setData([this.t, ...columns]);
    });
  };

  resize = () => {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (width < 40 || height < 40) return;
    const share = (height - TIMES) / Math.max(1, this.plots.length);
    this.plots.forEach((plot, p) => {
      const below = p === this.plots.length - 1 ? TIMES : 0;
      plot.setSize({ width, height: Math.max(20, share - LEGEND) + below });
    });
  };

  /** From when to when the plots go: the window ends with the last sample. */
  times = () => {
    const end = Math.max(this.ready.window, this.t[this.t.length - 1] ?? 0);
    return [end - this.ready.window, end];
  };

  plotOf = (panel, p) => {
    const isLast = p === this.panels.length - 1;
    const head = el("div", { class: "plot-head" }, el("span", { textContent: panelTitle(panel) }));
    const box = el("div", { class: "plot" }, head);
    this.host.append(box);
    const limits = panel.lines.flatMap(({ low, high }) => [low, high]).filter((limit) => Number.isFinite(limit));
    const plot = new uPlot(
      {
        width: 100,
        height: 100,
        padding: [4, 24, isLast ? 0 : 4, 0] /* half of the last time */,
        cursor: { y: false, sync: { key: "run" }, drag: { x: false, y: false }, points: { show: false } },
        legend: { mount: (_, table) => head.append(table), markers: { show: false } },
        scales: { x: { time: false, range: this.times }, y: { range: (_, ...ends) => valueRange(ends, limits) } },
        axes: [this.axis({ show: isLast, size: TIMES, unit: " s" }), this.axis({ size: VALUES, space: 24 })],
        series: [{ label: S.runTime, value: () => "" }].concat(panel.lines.flatMap((line) => this.seriesOf(line))),
        bands: panel.lines.map((line, k) => ({ series: [2 * k + 1, 2 * k + 2], fill: () => this.ink(line) })),
        hooks: { draw: [(drawn) => drawLimits(drawn, limits)] },
      },
      [[]],
      box,
    );
    const destroy = plot.destroy;
    plot.destroy = () => {
      destroy();
      box.remove();
    };
    return plot;
  };

  axis = ({ show = true, size, space = 60, unit = "" }) => ({
    show,
    size,
    space,
    font: FONTS.small,
    stroke: () => colourOf("--soft"),
    grid: { stroke: () => colourOf("--line"), width: 1 },
    ticks: { show: false },
    values: (_, numbers) => numbers.map((number) => shortNumber(number) + unit),
  });

  /** The greatest and the least values of a line; the legend has it once. */
  seriesOf = (line) => {
    const isReference = line.colour === null;
    const common = {
      stroke: () => this.ink(line),
      width: isReference ? 1.2 : 1.7,
      dash: isReference ? [4, 3] : [],
      points: { show: false },
    };
    return [
      {
        ...common,
        label: line.name || S.runReference,
        value: (_, number) => (Number.isFinite(number) ? shortNumber(number) : ""),
      },
      { ...common, class: "twin" },
    ];
  };

  /** The colour of a line: that of a term, as a canvas takes it. */
  ink = (line) => {
    if (line.colour === null) return colourOf("--soft");
    this.host.style.color = hue(line.colour);
    const ink = getComputedStyle(this.host).color;
    this.host.style.color = "";
    return ink;
  };
}

const panelTitle = ({ title, unit }) => (unit && unit !== "1" ? `${title}, ${unit}` : title);

/** Which columns stand in which plot: outputs with their references, their errors, then drives by unit. */
function panelsOf({ tracked, drives }) {
  const count = tracked.length;
  const numbered = tracked.map((port, i) => ({ ...port, i }));
  const units = [...new Set(tracked.map((port) => port.unit))];
  const driven = drives.map((port, i) => ({ ...port, column: 3 * count + i, colour: i }));
  return [
    ...units.flatMap((unit) => {
      const own = numbered.filter((port) => port.unit === unit);
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
    }),
    ...[...new Set(driven.map((port) => port.unit))].map((unit) => ({
      title: S.runDrives,
      unit,
      lines: driven.filter((port) => port.unit === unit),
    })),
  ];
}

/** Lines at the limits of drives. */
function drawLimits(plot, limits) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.strokeStyle = colourOf("--lit");
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash([5 * devicePixelRatio, 4 * devicePixelRatio]);
  for (const limit of limits) {
    const y = plot.valToPos(limit, "y", true);
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
  }
  ctx.restore();
}
