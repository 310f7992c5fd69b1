// What the panes of the page share, beside the messages: the store, and what a hand may do.

declare namespace Page {
  type Store = import("../../../src/fuzzyarm/apps/designer/page/store.js").Store;

  type Questions = Messages.TextQuestions;

  /** What an edit, a question or an act on the folder answers; `error` where it is refused. */
  type Answer = Partial<Messages.Answer> & { [name: string]: any };

  /** Long work that goes on: what it may be told. */
  interface Job {
    say(words: Messages.RunWord | Messages.LearnWord | Messages.TuneWord): void;
    stop(): void;
  }

  type News = Partial<Messages.JobNews> & { [name: string]: any };

  /** What a pane may do to the text and its folder. */
  interface Hand {
    edit(shapes: Array<Messages.TermShape>): any;
    numbers(variable: string): Promise<any>;
    change<Q extends keyof Questions>(what: Q, details: Questions[Q]): Promise<any>;
    attempt<Q extends keyof Questions>(what: Q, details: Questions[Q]): Promise<Answer>;
    askNow<Q extends keyof Questions>(what: Q, details?: Questions[Q]): Promise<Answer>;
    start<W extends keyof Messages.Works>(what: W, asked: Messages.Works[W], hear: (news: News) => void): Job;
    folder<Q extends keyof Messages.FolderQuestions>(
      asked: { what: Q } & Messages.FolderQuestions[Q],
    ): Promise<Answer>;
    fill(title: string, fields: any[], button: string, act: (values: any) => any, note?: string): Promise<any>;
    choose(title: string, texts: string[]): Promise<number | null>;
    settled(): Promise<boolean>;
    gone(): string;
    [name: string]: any;
  }

  /** What a line calls: when it is there, with a text that it brings, and when it is lost. */
  interface Ends {
    opened(): void;
    heard(text: string): void;
    closed(again: boolean): void;
  }

  type Line = (ends: Ends) => { send(text: string): void; isOpen(): boolean; drop(): void };

  /** What a window knows at once. */
  interface Start {
    files: string[];
    first: string;
    only: boolean;
    largest: number;
    imports: string[];
    nonce: string;
  }

  /** What a page has that is not that of the server: its line, and what it does with a desk that is new. */
  interface Around {
    line?: Line;
    /** Whether texts are kept when the window is closed. */
    keeps?: boolean;
    gone?(): { why: string; kept: string } | null;
    buttons?(hand: Hand): HTMLElement[];
    begin?(desk: any): void;
    moved?(desk: any, before: string): void;
    listed?(names: string[]): void;
    /** A file that has come to be. */
    stored?(file: { file: string; text: string }): void;
    /** Whether this tab writes a file, and have it do so; without, the server says which window does. */
    writes?(file: string): boolean;
    write?(file: string): void;
    /** Whether no other tab writes a file, which need not be open. */
    isFree?(file: string): Promise<boolean>;
  }

  /** Two numbers: an end and the other, or a place. */
  type Pair = [number, number];
}

interface Window {
  designer: any;
}
