// The engine of the page: printed from the kernel's source (fuzzyarm.designer.engine), not a file.
declare module "*/engine.js" {
  export class Engine {
    constructor(data: any);
    data: any;
    [name: string]: any;
  }
}
