/** Built package files for examples; written to the site's `kit/kit.json`. */
export interface KitManifest {
  /** File by import specifier, e.g. `three/webgpu`. */
  readonly entries: Readonly<Record<string, string>>;
  /** Static and dynamic imports of each file. */
  readonly imports: Readonly<Record<string, readonly string[]>>;
  /** Names of scenes in the same folder, which examples can load. */
  readonly scenes: readonly string[];
}

/** Specifier of a kit file in imports: modules from memory cannot use relative paths. */
export const kitSpecifier = (file: string): string => `kit:${file}`;

/** Kit entry that renders a component on the page. */
export const MOUNT_ENTRY = '@websplatter/docs/mount';

/** Kit entry that measures on the reader's GPU. */
export const MEASURE_ENTRY = '@websplatter/docs/measure';
