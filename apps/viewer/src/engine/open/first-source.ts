import { builtinScenes } from '@websplatter/scenes';
import type { FailureReport } from '../../state/messages.ts';
import type { AddressedScene } from '../link/addressed-scene.ts';
import { hardCaseNameIn } from '../link/case-addresses.ts';
import type { SceneSource } from './scene-source.ts';

/** The scene to open first. */
export interface FirstSource {
  /** One or more; all are shown together. */
  readonly sources: readonly SceneSource[];
  /** Message about an unknown scene name; null if there is none. */
  readonly notice: string | null;
  /** Why the URL's files cannot be opened; null if they can. */
  readonly failure: FailureReport | null;
}

/** The scene to open first. Relative URLs of files are resolved against `base`. */
export function firstSource(
  { held = [], addresses = [], scene }: AddressedScene,
  base: string,
  isSoftwareAdapter: boolean,
): FirstSource {
  if (held.length > 0) return { sources: held, notice: null, failure: null };
  const wrong = addresses.find((address) => !URL.canParse(address, base));
  if (wrong === undefined && addresses.length > 0) {
    const sources = addresses.map((address): SceneSource => ({ kind: 'url', url: new URL(address, base) }));
    return { sources, notice: null, failure: null };
  }
  const failure = wrong === undefined ? null : noAddress(wrong);
  const hardCase = hardCaseNameIn(scene);
  if (hardCase !== null) return { sources: [{ kind: 'hard-case', name: hardCase }], notice: null, failure };
  return { ...builtinSource(scene, isSoftwareAdapter), failure };
}

/** The built-in scene that fits every GPU. */
export function smallSource(): SceneSource {
  return builtinSource(null, true).sources[0];
}

/** The built-in scene that `?scene=` names, or the default. */
export function builtinSource(asked: string | null | undefined, isSoftwareAdapter: boolean): FirstSource {
  const name = hardCaseNameIn(asked) === null ? asked : null;
  const found = builtinScenes.find((scene) => scene.name === name);
  const [full, small] = builtinScenes;
  // A software rasterizer would take seconds per frame for the full scene.
  const scene = found ?? (isSoftwareAdapter ? small : full);
  return {
    sources: [{ kind: 'builtin', scene }],
    notice: name && !found ? `There is no built-in scene “${name}”.` : null,
    failure: null,
  };
}

function noAddress(text: string): FailureReport {
  return {
    title: 'The file cannot be opened',
    message: `“${text}” is not an address.`,
    advice:
      'Write ?src= and the address of a scene, whole or relative to this page; ?src=…&src=… for several.',
  };
}
