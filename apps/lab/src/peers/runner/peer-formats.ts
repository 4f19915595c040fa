import type { PeerFormats } from '../adapter.ts';
import type { SceneFormat } from './scenes.ts';

/** Whether a peer that reads `formats` reads `format`. */
export function isReadBy(formats: PeerFormats, { name, variant }: SceneFormat): boolean {
  return formats === 'any' || formats.includes(name) || formats.includes(`${name} ${variant}`);
}
