/** Built files of the packages that examples run with; written to `kit/kit.json` of the site. */
export interface KitManifest {
  /** File by the specifier under which it is imported, e.g. `three/webgpu`. */
  readonly entries: Readonly<Record<string, string>>;
  /** Files that each file may import, at once or later. */
  readonly imports: Readonly<Record<string, readonly string[]>>;
  /** Scenes beside them, which examples load by these names. */
  readonly scenes: readonly string[];
}

/** Specifier between files of the kit: modules from memory have no relative paths. */
export const kitSpecifier = (file: string): string => `kit:${file}`;

/** Entry of the kit that shows a component on the page. */
export const MOUNT_ENTRY = '@websplatter/docs/mount';

/** Entry of the kit that measures on the reader's GPU. */
export const MEASURE_ENTRY = '@websplatter/docs/measure';
