// Charts over time, as a module of the page.
export { default as uPlot } from "uplot";
