import { builtinScenes } from '@websplatter/scenes';
import type { FailureReport } from '../state/messages.ts';
import type { AddressedScene } from './addressed-scene.ts';
import { hardCaseNameIn } from './case-addresses.ts';
import type { SceneSource } from './scene-source.ts';

/** The scene to open first. */
export interface FirstSource {
  /** One or more, which are shown together. */
  readonly sources: readonly SceneSource[];
  /** The problem with the name of a scene, in words. */
  readonly notice: string | null;
  /** Why the files of the address cannot be opened. */
  readonly failure: FailureReport | null;
}

/** The scene to open first; relative addresses of files start from `base`. */
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

/** The built-in scene that no GPU is too small for. */
export function smallSource(): SceneSource {
  return builtinSource(null, true).sources[0];
}

/** The built-in scene that `?scene=` asks for, or the default. */
export function builtinSource(asked: string | null | undefined, isSoftwareAdapter: boolean): FirstSource {
  const name = hardCaseNameIn(asked) === null ? asked : null;
  const found = builtinScenes.find((scene) => scene.name === name);
  const [full, small] = builtinScenes;
  // A software rasteriser would need seconds per frame for the full scene.
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
    isFault: false,
  };
}
