import { encodePly, readSplats } from '@websplatter/core';
import { mergeSplats, writeSplats } from '@websplatter/core/write';
import { expect, test } from 'vitest';
import { oneSplat } from '../engine/open/one-splat.fixture.ts';
import type { Placement } from '../state/scene-part.ts';
import { cutFile } from './write-scene.ts';

/** A file of splats at these x. */
const splatsAt = (...xs: readonly number[]) =>
  mergeSplats(xs.map((x) => ({ ...oneSplat, positions: Float32Array.of(x, 2, 3) })));
const sourceOf = (bytes: Uint8Array<ArrayBuffer>, name = 'a.ply') => ({
  kind: 'file' as const,
  name,
  source: new File([bytes], name),
});
const [plain, nothing] = [{ placement: null, rows: null, crop: null }, () => {}];
const removed = (...words: readonly number[]) => ({ words: Uint32Array.from(words), areSaved: false });

async function xsOf(bytes: Uint8Array<ArrayBuffer>): Promise<number[]> {
  const { count, positions, origin } = await readSplats(bytes);
  return Array.from({ length: count }, (_, i) => Math.round(positions[3 * i] + origin[0])).sort();
}

test('a cut file has only what crop and removals leave, in its own place', async () => {
  const source = sourceOf(encodePly(splatsAt(1, 2, 3, 4)));
  // Moved by 10: the crop is in the scene's space, the file's rows stay where they are.
  const placement: Placement = {
    ...{ move: [10, 0, 0], turnDegrees: [0, 0, 0], scale: 1, about: [0, 0, 0] },
    ...{ up: '-y', sceneUp: '-y' },
  };
  const crop = { min: [11.5, 0, 0], max: [13.5, 9, 9], keep: 'inside' } as const;
  const phases = new Set<string>();
  const cut = await cutFile({ source, placement, rows: removed(0b10), crop }, ({ phase }) =>
    phases.add(phase),
  );
  expect(cut).toMatchObject({ kind: 'file', extension: '.sog', notes: [] });
  expect(cut.kind === 'file' && (await xsOf(cut.bytes))).toEqual([3]);
  expect([...phases]).toEqual(['read', 'write']);
});

test.each([
  ['spz', 'sog'],
  ['gltf', 'gltf'],
])('a cut %s is %s', async (formatName, cutName) => {
  const source = sourceOf(await writeSplats(splatsAt(1, 2, 3), formatName), `a.${formatName}`);
  const cut = await cutFile({ ...plain, source, rows: removed(0b1) }, nothing);
  expect(cut.kind === 'file' && (await readSplats(cut.bytes)).fileFacts?.format).toBe(cutName);
  expect(cut.kind === 'file' && (await xsOf(cut.bytes))).toEqual([2, 3]);
});

test('a file of which nothing is hidden is not written again, nor one of which nothing is left', async () => {
  const source = sourceOf(encodePly(splatsAt(1, 2)));
  const crop = { min: [0, 0, 0], max: [9, 9, 9] } as const;
  expect(await cutFile({ ...plain, source, crop: { ...crop, keep: 'inside' } }, nothing)).toEqual({
    kind: 'all',
  });
  expect(await cutFile({ ...plain, source, crop: { ...crop, keep: 'outside' } }, nothing)).toEqual({
    kind: 'nothing',
  });
  expect(await cutFile({ ...plain, source, rows: removed(0b11) }, nothing)).toEqual({ kind: 'nothing' });
});
