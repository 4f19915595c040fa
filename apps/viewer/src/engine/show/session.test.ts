import { ACCURACY_PRESETS, type SplatEngine } from '@websplatter/core';
import { describe, expect, it, vi } from 'vitest';
import { Views } from './session.ts';

const { fast, reference } = ACCURACY_PRESETS;
const canvas = {} as HTMLCanvasElement;

function setUp() {
  const createView = vi.fn(() => ({ whenDrawn: () => Promise.resolve(), destroy: vi.fn() }));
  const device = { queue: { onSubmittedWorkDone: () => Promise.resolve() } };
  const views = new Views({ createView, device } as unknown as SplatEngine, canvas, () => {});
  return { views, createView };
}

describe('Views', () => {
  it('measures a target in the view that is drawn with it', () => {
    const { views } = setUp();
    views.createRight(canvas);
    expect(views.targeting(null)).toBe(views.main);
    expect(views.targeting({ kind: 'error' })).toBe(views.main);
    expect(views.targeting({ kind: 'split', left: 'current', right: reference })).toBe(views.main);
    expect(views.targeting({ kind: 'split', left: fast, right: 'current' })).toBe(views.right);
    expect(views.targeting({ kind: 'split', left: fast, right: reference })).toBe(views.probe);
  });

  it('measures a target beside the screen while the right side has no canvas', () => {
    const { views } = setUp();
    expect(views.targeting({ kind: 'split', left: fast, right: 'current' })).toBe(views.probe);
  });

  it('makes the probe once, and the right side once per canvas', () => {
    const { views, createView } = setUp();
    expect(views.probe).toBe(views.probe);
    views.createRight(canvas);
    const { right } = views;
    views.createRight(canvas);
    expect(views.right).toBe(right);
    expect(createView).toHaveBeenCalledTimes(3);
    views.destroyRight();
    expect(right?.destroy).toHaveBeenCalledOnce();
    expect(views.right).toBeNull();
  });
});
