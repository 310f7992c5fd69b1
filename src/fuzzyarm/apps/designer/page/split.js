// Handles between panes: dragged with the mouse, moved with the arrow keys, and remembered.
//
// A handle stands between two tracks of a grid, which share their room by the properties `--KEY-a` and
// `--KEY-b` of the whole page: so all files have their panes alike.

import { el } from "./draw.js";
import { S } from "./strings.js";

const LEAST_SHARE = 0.08; // of the room of two tracks
const STEPS = { ArrowLeft: -0.02, ArrowUp: -0.02, ArrowRight: 0.02, ArrowDown: 0.02, PageUp: -0.1, PageDown: 0.1 };

/** A share that leaves both tracks some room. */
export const bounded = (share) => Math.min(1 - LEAST_SHARE, Math.max(LEAST_SHARE, share));

/** The share of the first of two tracks where a handle between them is at a position. */
export const shareAt = (position, start, first, handle, second) =>
  bounded((position - start - handle / 2) / Math.max(1, first + second));

/** Where a share goes by a key; null where the key means nothing here. */
export function shareBy(key, share, usual, vertical) {
  if (key === "Home") return LEAST_SHARE;
  if (key === "End") return 1 - LEAST_SHARE;
  if (key === "Enter") return usual;
  const isAcross = /Left|Right/.test(key);
  const step = /^Arrow/.test(key) && isAcross !== vertical ? undefined : STEPS[key];
  return step === undefined ? null : bounded(share + step);
}

/** Sizes of tracks as a browser says them, `"120px 8px 300px"`. */
export const sizesOf = (tracks) => tracks.split(" ").map(parseFloat).filter(Number.isFinite);

const kept = {
  read: (key) => {
    try {
      return Number(localStorage.getItem(`fuzzyarm.split.${key}`)) || null;
    } catch {
      return null; // a page without a server may have none
    }
  },
  write: (key, share) => {
    try {
      if (share === null) localStorage.removeItem(`fuzzyarm.split.${key}`);
      else localStorage.setItem(`fuzzyarm.split.${key}`, share.toFixed(4));
    } catch {
      /* it is not remembered */
    }
  },
};

/**
 * A handle of a grid. `key` is what its place is remembered under, `vertical` whether it stands between
 * columns, `at` which track of the grid it is, and `usual` the share of the track in front of it.
 */
export function splitter({ key, vertical, at, usual }) {
  const root = document.documentElement;
  // Of several files each has a handle: what one says counts for all, remembered or not.
  const now = () => parseFloat(root.style.getPropertyValue(`--${key}-a`)) || null;
  let share = now() ?? kept.read(key) ?? usual;
  const handle = el("div", {
    class: `split ${vertical ? "columns" : "rows"}`,
    role: "separator",
    tabIndex: 0,
    title: S.split,
    "aria-label": S.splitOf(vertical),
    "aria-orientation": vertical ? "vertical" : "horizontal",
    "aria-valuemin": Math.round(100 * LEAST_SHARE),
    "aria-valuemax": Math.round(100 - 100 * LEAST_SHARE),
  });

  function put(next, isDone = true) {
    share = next;
    root.style.setProperty(`--${key}-a`, `${share}fr`);
    root.style.setProperty(`--${key}-b`, `${1 - share}fr`);
    tell();
    if (isDone) kept.write(key, share === usual ? null : share);
  }

  const tell = () => handle.setAttribute("aria-valuenow", String(Math.round(100 * share)));

  /** Where the tracks of the grid are now. */
  function tracks() {
    const grid = handle.parentElement;
    const style = getComputedStyle(grid);
    const sizes = sizesOf(vertical ? style.gridTemplateColumns : style.gridTemplateRows);
    const gap = parseFloat(vertical ? style.columnGap : style.rowGap) || 0;
    const box = grid.getBoundingClientRect();
    const pad = parseFloat(vertical ? style.paddingLeft : style.paddingTop) || 0;
    const start =
      (vertical ? box.left : box.top) + pad + sizes.slice(0, at - 1).reduce((sum, size) => sum + size + gap, 0);
    return [start, sizes[at - 1], sizes[at], sizes[at + 1]];
  }

  handle.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    handle.focus();
    handle.setPointerCapture(event.pointerId);
    const [start, ...sizes] = tracks();
    handle.onpointermove = (move) => put(shareAt(vertical ? move.clientX : move.clientY, start, ...sizes), false);
    handle.onpointerup = handle.onpointercancel = () => {
      handle.onpointermove = handle.onpointerup = handle.onpointercancel = null;
      put(share);
    };
  });
  handle.addEventListener("dblclick", () => put(usual));
  handle.addEventListener("keydown", (event) => {
    const next = shareBy(event.key, now(), usual, vertical);
    if (next === null || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    put(next);
  });
  handle.addEventListener("focus", () => put(now(), false));
  put(share, false);
  return handle;
}
