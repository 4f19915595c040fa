/**
 * Request to run an example. It contains all files, because the page that runs
 * it has an opaque origin and can fetch none.
 */
export interface RunMessage {
  readonly kind: 'run';
  /** Texts of kit files that the example may need, by name. */
  readonly kit: Readonly<Record<string, string>>;
  /** File of the kit by specifier. */
  readonly entries: Readonly<Record<string, string>>;
  readonly modules: Readonly<Record<string, string>>;
  readonly entry: string;
  /** Source of the worker that reads files. */
  readonly loadWorker: string;
  /** Files that the example may load, by the name in its source. */
  readonly scenes: Readonly<Record<string, ArrayBuffer>>;
}

/** Report from the page of an example. */
export type RunReport =
  | { readonly kind: 'ready' }
  /** The modules have run and a component, if any, is mounted. */
  | { readonly kind: 'running' }
  /** A canvas shows a picture, or a message explains why none does. */
  | { readonly kind: 'drawn' }
  /** `line` counts from 1; null if the reason is in none of the example's files. */
  | {
      readonly kind: 'problem';
      readonly message: string;
      readonly path: string | null;
      readonly line: number | null;
    };
