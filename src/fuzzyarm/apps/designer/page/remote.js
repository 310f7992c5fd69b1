// What the page does not compute by itself, or not as finely: asked of the server, beside the rest.

import { ACROSS } from "./store.js";
import { evenly } from "./geometry/chart.js";
import { rangeOf } from "./geometry/shapes.js";

const WAIT = 60; // ms after the last change

/**
 * Keep the surface and the point known that the page has from the server.
 *
 * @param {Page.Store} store
 */
export function askServer(store, start) {
  let work = null;
  let asked = ""; // what the work that runs, or ran, was for
  let waiting = 0;

  const wanted = () => {
    if (!store.scene || store.scene.missing.length || store.stale || store.busy || (store.running && !store.coarse))
      return "";
    return store.surfaceKey() + (store.running ? "" : JSON.stringify(store.point));
  };

  function ask() {
    const key = wanted();
    if (!key || key === asked) return;
    if (work) {
      work.stop(); // and once more when it has ended
      return;
    }
    asked = key;
    const { scene, point, axes } = store;
    const surface = store.surfaceKey();
    const isKnown = store.far?.key === surface && !store.running;
    const ends = [axes.x, axes.y].map((i) => rangeOf(scene.inputs[i]));
    const across = isKnown ? 2 : ACROSS; // only the point is new
    work = start("surface", { ...axes, point, ends, across, fired: !store.running }, (news) => {
      if (store.scene !== scene) {
        if (news.end) again();
        return;
      }
      if (news.strengths) {
        store.told = { strengths: news.strengths, outputs: news.outputs.map((value) => value ?? NaN) };
        store.emit("told");
      }
      if (news.z && !isKnown) {
        const [xs, ys] = ends.map((each) => evenly(each, across));
        const z = Float64Array.from(news.z, (value) => value ?? NaN);
        store.far = { key: surface, xs, ys, z, rows: axes.x === axes.y ? 1 : across, isFar: true };
        store.emit("told");
      }
      if (news.end === "failed") {
        store.refused = news.message;
        store.emit("told");
      }
      if (news.end) again();
    });
  }

  function again() {
    work = null;
    if (wanted() !== asked) soon();
  }

  function soon() {
    clearTimeout(waiting);
    waiting = setTimeout(ask, WAIT);
  }

  store.on("scene", () => {
    asked = store.refused = "";
    soon();
  });
  for (const name of ["point", "axes", "reshaped", "coarse"]) store.on(name, soon);
}
