import { hardCaseNameIn } from '../hard-cases/catalogue.ts';
import { defaultSceneName, findBuiltinScene } from './builtin-scene.ts';
import type { SceneSource } from './scene-source.ts';

/** The scene that the page's address asks for: `?file=URL`, `?scene=NAME` and `?scene=hard:NAME`. */
export interface AddressedScene {
  readonly file?: string | null;
  readonly scene?: string | null;
}

export interface FirstSource {
  readonly source: SceneSource;
  /** The problem with the address, in words. */
  readonly notice: string | null;
}

/** What to open first; relative addresses of files start from `base`. */
export function firstSource(
  { file, scene }: AddressedScene,
  base: string,
  isSoftwareAdapter: boolean,
): FirstSource {
  if (file && URL.canParse(file, base))
    return { source: { kind: 'url', url: new URL(file, base) }, notice: null };
  const notice = file ? `“${file}” is not an address.` : null;
  const hardCase = hardCaseNameIn(scene);
  if (hardCase !== null) return { source: { kind: 'hard-case', name: hardCase }, notice };
  const builtin = builtinSource(scene, isSoftwareAdapter);
  return { source: builtin.source, notice: builtin.notice ?? notice };
}

/** The built-in scene that no GPU is too small for. */
export function smallSource(): SceneSource {
  return builtinSource(null, true).source;
}

/** The built-in scene that `?scene=` asks for, or the default. */
export function builtinSource(asked: string | null | undefined, isSoftwareAdapter: boolean): FirstSource {
  const name = hardCaseNameIn(asked) === null ? asked : null;
  const found = name ? findBuiltinScene(name) : undefined;
  const scene = found ?? findBuiltinScene(defaultSceneName(isSoftwareAdapter));
  if (!scene) throw new Error('The default scene is missing.');
  return {
    source: { kind: 'builtin', scene },
    notice: name && !found ? `There is no built-in scene “${name}”.` : null,
  };
}
