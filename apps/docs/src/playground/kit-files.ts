import { type KitManifest, kitSpecifier } from './kit-manifest.ts';

/** This site's kit. Files are fetched on demand and cached. */
export class KitFiles {
  readonly #folder: URL;
  readonly #texts = new Map<string, Promise<string>>();
  readonly #scenes = new Map<string, Promise<ArrayBuffer>>();
  #manifest: Promise<KitManifest> | null = null;

  /** @param folder URL of the kit, with a trailing slash. */
  constructor(folder: URL) {
    this.#folder = folder;
  }

  manifest(): Promise<KitManifest> {
    this.#manifest ??= this.#read('kit.json').then((response) => response.json());
    return this.#manifest;
  }

  /** URL of the file for `specifier`. */
  async addressOf(specifier: string): Promise<string> {
    return new URL((await this.manifest()).entries[specifier], this.#folder).href;
  }

  text(file: string): Promise<string> {
    return kept(this.#texts, file, () => this.#read(file).then((response) => response.text()));
  }

  scene(name: string): Promise<ArrayBuffer> {
    return kept(this.#scenes, name, () => this.#read(name).then((response) => response.arrayBuffer()));
  }

  /** Texts of all files that `packages` may import. They import one another by `kitSpecifier`. */
  async modules(packages: readonly string[]): Promise<Record<string, string>> {
    const { entries, imports } = await this.manifest();
    const files = reachable(
      packages.map((specifier) => entries[specifier]),
      imports,
    );
    const texts = files.map(async (file) => [file, linked(await this.text(file), imports[file])] as const);
    return Object.fromEntries(await Promise.all(texts));
  }

  async #read(file: string): Promise<Response> {
    const response = await fetch(new URL(file, this.#folder));
    if (!response.ok)
      throw new Error(`${file} of this site cannot be read: the server answers ${response.status}.`);
    return response;
  }
}

/** Returns the cached promise for `key`, unless it has rejected. */
function kept<Value>(
  map: Map<string, Promise<Value>>,
  key: string,
  begin: () => Promise<Value>,
): Promise<Value> {
  const before = map.get(key);
  if (before) return before;
  const begun = begin();
  map.set(key, begun);
  // Callers of `begun` get the error; a later call tries again.
  begun.catch(() => map.delete(key));
  return begun;
}

/** `files` and their imports, recursively. */
export function reachable(files: readonly string[], imports: KitManifest['imports']): string[] {
  const found = new Set(files);
  for (const file of found) for (const other of imports[file] ?? []) found.add(other);
  return [...found];
}

/** Rewrites a module's relative imports of `others`, so that they work from memory too. */
export function linked(text: string, others: readonly string[]): string {
  return others.reduce(
    (code, other) =>
      ['"', "'", '`'].reduce(
        (each, quote) =>
          each.replaceAll(`${quote}./${other}${quote}`, `${quote}${kitSpecifier(other)}${quote}`),
        code,
      ),
    text,
  );
}
