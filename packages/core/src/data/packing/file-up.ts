import { given } from '../given.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { CloudFacts } from './cloud-facts.ts';

/**
 * Up in files of a format that defines it, in the file's own axes: y for glTF. Null for clouds of
 * other formats, of which no program keeps to one axis, and of arrays.
 *
 * @example
 * const up = fileUp(cloud.facts) ?? [0, -1, 0];
 */
export function fileUp(facts: Pick<CloudFacts, 'fileFacts'>): Vec3 | null {
  const { fileFacts } = given(facts, {}, 'facts');
  return fileFacts?.format === 'gltf' ? [0, 1, 0] : null;
}

/** Up in most captures, whose files do not say. */
export const USUAL_UP: Vec3 = [0, -1, 0];
