/** Of a minified file `tsc` infers too little. */
export declare const uPlot: any;
