// Proves: a cloud with a time is drawn at it; a file of frames, which has none, tells so.
import type { SplatCloud, SplatEngine } from '@websplatter/core';
import { Matrix4 } from 'three/webgpu';
import { afterEach, expect, test, vi } from 'vitest';
import type { LayerCloud } from './layer-cloud.ts';
import { instanceOf } from './layer-request.ts';

afterEach(() => {
  vi.restoreAllMocks();
});

const engine = {} as SplatEngine;

function objectAt(time: number | null, fileFacts: object): LayerCloud {
  const cloud = { name: 'dancer.frames', facts: { fileFacts } } as unknown as SplatCloud;
  return { time, uploadedTo: () => cloud, matrixWorld: new Matrix4() } as unknown as LayerCloud;
}

const FRAMES = { format: 'frames', frames: { count: 8, perS: 30, bytes: 1000 } };

test('a time chooses no frame of a file: the console says once what does', () => {
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
  const object = objectAt(0.5, FRAMES);
  expect(instanceOf(object, engine, [])).toMatchObject({ time: 0.5 });
  instanceOf(object, engine, []);
  expect(warn.mock.calls).toEqual([
    [
      'dancer.frames has frames, of which `time` chooses none. Play them by useSplatSequence or SplatSequence.',
    ],
  ]);
});

test('nothing is said of a frame without a time, nor of other files', () => {
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
  expect(instanceOf(objectAt(null, FRAMES), engine, [])).toMatchObject({ time: undefined });
  instanceOf(objectAt(0.5, { format: 'ply' }), engine, []);
  expect(warn).not.toHaveBeenCalled();
});
