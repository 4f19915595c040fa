import { DestroyedError, GpuLimitError } from '@websplatter/core';
import { coverageOf } from '@websplatter/three';
import { Object3D, PerspectiveCamera } from 'three';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { LabelBoard } from './label-board.ts';

vi.mock('@websplatter/three', () => ({ coverageOf: vi.fn() }));

const camera = new PerspectiveCamera(50, 1, 0.1, 100);
const view = { renderer: {}, scene: new Object3D(), camera, size: { width: 200, height: 100 } };

let board: LabelBoard;
/** Answers the oldest question. */
let answers: ((found: unknown) => void)[];
let failures: ((error: Error) => void)[];

beforeEach(() => {
  vi.useFakeTimers();
  [answers, failures] = [[], []];
  vi.mocked(coverageOf).mockReset();
  vi.mocked(coverageOf).mockImplementation(
    () =>
      new Promise((resolve, reject) => {
        answers.push(resolve as (found: unknown) => void);
        failures.push(reject);
      }),
  );
  board = new LabelBoard(() => view);
});
afterEach(() => {
  expect(vi.getTimerCount(), 'timers left').toBe(0);
  vi.useRealTimers();
});

function labelAt(x: number, y: number, z: number, changes = {}) {
  const object = new Object3D();
  object.position.set(x, y, z);
  object.updateMatrixWorld();
  const label = {
    object,
    canBeCovered: true,
    hideAt: 0.5,
    tolerance: undefined,
    place: vi.fn(),
    leaveSight: vi.fn(),
    cover: vi.fn(),
    ...changes,
  };
  return { ...label, remove: board.add(label) };
}

async function frame(): Promise<void> {
  board.noteFrame();
  board.noteFrame();
  await Promise.resolve();
}

const turn = () => vi.advanceTimersByTimeAsync(0);

it('places labels after a frame, by distance, and those out of sight not at all', async () => {
  const far = labelAt(0, 0, -10);
  const near = labelAt(0.5, 0, -2);
  const behind = labelAt(0, 0, 2);
  const beside = labelAt(9, 0, -2);
  await frame();
  expect(far.place.mock.calls).toEqual([[100, 50, 10, 1]]);
  expect(near.place.mock.calls).toEqual([[expect.closeTo(153.6, 1), 50, 2, 0]]);
  for (const label of [behind, beside]) {
    expect(label.leaveSight).toHaveBeenCalledOnce();
    expect(label.place).not.toHaveBeenCalled();
  }
  await turn();
  for (const label of [far, near, behind, beside]) label.remove();
  answers[0]([]);
});

it('asks once for all labels in sight that may be covered, and tells each', async () => {
  const covered = labelAt(0, 0, -10);
  const free = labelAt(0, 0, -5, { tolerance: 0.3, hideAt: 0.9 });
  const behindMesh = labelAt(0, 0, -4);
  const always = labelAt(0, 0, -3, { canBeCovered: false });
  labelAt(0, 0, 2);
  await frame();
  expect(coverageOf, 'within the frame').not.toHaveBeenCalled();
  await turn();
  expect(vi.mocked(coverageOf).mock.calls).toEqual([
    [
      view.renderer,
      view.scene,
      camera,
      [
        { point: [0, 0, -10], tolerance: 0.2 },
        { point: [0, 0, -5], tolerance: 0.3 },
        { point: [0, 0, -4], tolerance: 0.08 },
      ],
    ],
  ]);
  const opacities = [0.6, 0.6, 0];
  answers[0](opacities.map((opacity, i) => ({ isInImage: true, opacity, isBehindHost: i === 2 })));
  await turn();
  const told = [covered, free, behindMesh, always].map(({ cover }) => cover.mock.lastCall);
  expect(told).toEqual([[true], [false], [true], [false]]);
});

it('asks no second time before the first answer, nor within a tenth of a second, nor without a frame', async () => {
  const label = labelAt(0, 0, -10);
  await frame();
  await turn();
  for (let i = 0; i < 5; i++) {
    await frame();
    await vi.advanceTimersByTimeAsync(100);
  }
  expect(coverageOf).toHaveBeenCalledTimes(1);
  answers[0](null);
  await turn();
  // The frames in the meantime.
  expect(coverageOf).toHaveBeenCalledTimes(2);
  expect(label.cover.mock.calls).toEqual([[false]]);
  await frame();
  answers[1](null);
  await vi.advanceTimersByTimeAsync(99);
  expect(coverageOf).toHaveBeenCalledTimes(2);
  await vi.advanceTimersByTimeAsync(1);
  expect(coverageOf).toHaveBeenCalledTimes(3);
  answers[2](null);
  await vi.advanceTimersByTimeAsync(1000);
  expect(coverageOf).toHaveBeenCalledTimes(3);
});

it('leaves labels as they are when the device is lost, and warns of what else fails', async () => {
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
  const label = labelAt(0, 0, -10);
  const lack = new GpuLimitError('memory', 8, 0, 'No memory.');
  for (const error of [new DestroyedError('This view', 'it was destroyed'), lack]) {
    await frame();
    await vi.advanceTimersByTimeAsync(100);
    failures.at(-1)!(error);
    await turn();
  }
  expect(label.cover).not.toHaveBeenCalled();
  expect(warn.mock.calls).toEqual([[lack]]);
  warn.mockRestore();
});

it('asks for nothing once the last label is gone, and tells none that is', async () => {
  const label = labelAt(0, 0, -10);
  await frame();
  await turn();
  await frame();
  label.remove();
  answers[0]([{ isInImage: true, opacity: 1, isBehindHost: false }]);
  await vi.advanceTimersByTimeAsync(1000);
  expect(label.cover).not.toHaveBeenCalled();
  await frame();
  await vi.advanceTimersByTimeAsync(1000);
  expect(coverageOf).toHaveBeenCalledTimes(1);
});

it('asks in parts for very many labels', async () => {
  for (let i = 0; i < 300; i++) labelAt(0, 0, -10);
  await frame();
  await turn();
  answers[0](null);
  await turn();
  expect(vi.mocked(coverageOf).mock.calls.map(([, , , points]) => points.length)).toEqual([256, 44]);
  answers[1](null);
  await turn();
});
