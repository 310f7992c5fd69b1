// The page without a server: the terms can be moved, the text follows.

import { el, space } from "./draw.js";
import { Frame } from "./frame.js";
import { listingPane } from "./listing.js";
import { Store } from "./store.js";
import { S } from "./strings.js";

const given = JSON.parse(document.getElementById("start").textContent);
const model = new Store();
const listing = listingPane(given);
/** @type {Partial<Page.Hand>} */
const actions = {
  edit: (shapes) => listing.reshape(shapes),
  numbers: async (variable) => given.held[variable],
  setCell: null,
  goTo: null,
};
const { root } = new Frame(model, /** @type {Page.Hand} */ (actions), listing.section, [
  el("strong", { textContent: given.scene.name }),
  el("span", { id: "status", textContent: given.scene.description }),
  space(),
  el("small", { textContent: S.madeBy(given.version) }),
]);
document.body.append(root);
model.show(given.scene);
window.designer = { store: model };
