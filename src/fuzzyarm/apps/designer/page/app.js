// The page of the server.

import { COMPARE } from "./compare.js";
import { DiagramPane } from "./diagram.js";
import { FILES } from "./files.js";
import { FIT } from "./fit.js";
import { DESIGN } from "./frame.js";
import { LEARN } from "./learn.js";
import { MARGINS, PROVE } from "./prove.js";
import { RUN } from "./run.js";
import { SWEEP } from "./sweep.js";
import { TABLE } from "./table.js";
import { TUNE } from "./tune.js";
import { expose, openWindow } from "./window.js";

const DRAWN = { ...DESIGN, panes: [...DESIGN.panes, DiagramPane] };
const VIEWS = [DRAWN, RUN, TABLE, SWEEP, LEARN, FIT, TUNE, PROVE, MARGINS, COMPARE, FILES];

const start = JSON.parse(document.getElementById("start").textContent);
expose(openWindow(start, VIEWS));
