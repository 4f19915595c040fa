/** Request to run an example. It carries everything: a page of opaque origin fetches nothing. */
export interface RunMessage {
  readonly kind: 'run';
  /** Texts of the kit's files that the example may need, by name. */
  readonly kit: Readonly<Record<string, string>>;
  /** File of the kit by specifier. */
  readonly entries: Readonly<Record<string, string>>;
  readonly modules: Readonly<Record<string, string>>;
  readonly entry: string;
  /** The script that reads files. */
  readonly loadWorker: string;
  /** Files that the example may load, by the name that it uses. */
  readonly scenes: Readonly<Record<string, ArrayBuffer>>;
}

/** Report of the page of an example. */
export type RunReport =
  | { readonly kind: 'ready' }
  /** The modules have run, and a component, if there is one, is on the page. */
  | { readonly kind: 'running' }
  /** A canvas shows something, or a sentence says why none does. */
  | { readonly kind: 'drawn' }
  /** `line` counts from 1; null where the reason is in none of the example's files. */
  | {
      readonly kind: 'problem';
      readonly message: string;
      readonly path: string | null;
      readonly line: number | null;
    };
