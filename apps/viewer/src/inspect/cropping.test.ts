import { perspectiveCamera } from '@websplatter/core';
import type { EffectUse } from '@websplatter/core/effects';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { type Crop, isKept } from '../state/inspecting.ts';
import { Cropping, faceMiddle, SLIDER_STEPS, sliderPosition, sliderValue, withSide } from './cropping.ts';
import { cropVolume } from './draw-crop.ts';
import { EditHistory } from './edit-history.ts';
import { fakeTools } from './inspect-tools.fixture.ts';

const crop: Crop = { min: [0, -1, 2], max: [1, 1, 6], keep: 'inside' };

describe('the volume that is drawn', () => {
  it('is the box, turned with the scene', () => {
    expect(cropVolume(crop, false)).toEqual({
      shape: 'box',
      mode: 'keep',
      center: [0.5, 0, 4],
      size: [1, 2, 4],
    });
    const { center, size, mode } = cropVolume({ ...crop, keep: 'outside' }, true);
    expect(center.map(Math.abs)).toEqual([0.5, 0, 4]);
    expect(center[2]).toBe(-4);
    expect(size).toEqual([1, 2, 4]);
    expect(mode).toBe('hide');
  });
});

describe('a side that is moved', () => {
  it('takes the other along where they would pass each other', () => {
    expect(withSide(crop, 'max', 1, 0.5)).toEqual({ ...crop, max: [1, 0.5, 6] });
    expect(withSide(crop, 'min', 2, 7)).toEqual({ ...crop, min: [0, -1, 7], max: [1, 1, 7] });
    expect(withSide(crop, 'max', 2, 1)).toEqual({ ...crop, min: [0, -1, 1], max: [1, 1, 1] });
  });
});

it('has faces with a middle', () => {
  expect(faceMiddle(crop, 'min', 0)).toEqual([0, 0, 4]);
  expect(faceMiddle(crop, 'max', 2)).toEqual([0.5, 0, 6]);
});

describe('a slider', () => {
  it('has a value at each position, which has that position', () => {
    fc.assert(
      fc.property(
        fc.integer({ min: 0, max: SLIDER_STEPS }),
        fc.double({ min: 0.01, max: 0.99, noNaN: true }),
        (position, part) => {
          const range = { low: -3, high: 5, middle: -3 + 8 * part };
          expect(sliderPosition(sliderValue(position, range), range)).toBe(position);
        },
      ),
    );
  });

  it('ends where its range does, and stays finite where that has no side', () => {
    const range = { low: -3, high: 5, middle: 0 };
    expect([0, SLIDER_STEPS / 2, SLIDER_STEPS].map((each) => sliderValue(each, range))).toEqual([-3, 0, 5]);
    const oneSided = { low: 0, high: 5, middle: 0 };
    expect(sliderPosition(0, oneSided)).toBe(SLIDER_STEPS / 2);
    expect(sliderValue(0, oneSided)).toBe(0);
  });
});

describe('cropping', () => {
  /** The scene of the fake has one cloud. */
  const showCloud = ({ viewer }: ReturnType<typeof fakeTools>) => {
    const part = { key: 3, look: {}, loaded: { clouds: [{}] } };
    Object.assign(viewer.scenes, { newest: { parts: [part] } });
  };
  const volumesOf = ({ viewer }: ReturnType<typeof fakeTools>) =>
    (viewer.setEffects.mock.lastCall?.[1] as EffectUse[] | undefined)?.flatMap(
      ({ options }) => options as readonly unknown[],
    );

  it('draws what stays at once, and counts it', async () => {
    const fake = fakeTools();
    const removed = new Map([['3/0', Uint32Array.of(0b10)]]);
    showCloud(fake);
    fake.tools.update({ selecting: { ...fake.inspecting().selecting, removed } });
    fake.ask.mockResolvedValue([Uint32Array.of(0b1111)]);
    const cropping = new Cropping(fake.tools, new EditHistory(fake.tools));
    cropping.set(crop);
    expect(volumesOf(fake)).toEqual([cropVolume(crop, false)]);
    // Of four splats in the box, one is removed.
    await expect.poll(() => fake.inspecting().cropCount).toBe(3);
    fake.store.setState({
      isFlipped: true,
      requested: { ...fake.store.getState().requested, crop: [{} as never] },
    });
    cropping.draw();
    expect(volumesOf(fake)).toEqual([cropVolume(crop, true)]);
    cropping.set(null);
    expect(volumesOf(fake)).toEqual([]);
    expect(fake.inspecting()).toMatchObject({ crop: null, cropCount: null });
  });

  it('counts the newest box only, once a count is done', async () => {
    const fake = fakeTools();
    showCloud(fake);
    const answers: ((masks: unknown) => void)[] = [];
    fake.ask.mockImplementation(() => new Promise((resolve) => answers.push(resolve)));
    const cropping = new Cropping(fake.tools, new EditHistory(fake.tools));
    const boxes = [1, 2, 3].map((x) => withSide(crop, 'max', 0, x));
    for (const each of boxes) cropping.set(each);
    expect(fake.ask).toHaveBeenCalledOnce();
    answers[0]([Uint32Array.of(1)]);
    await expect.poll(() => fake.ask.mock.calls.length).toBe(2);
    expect(fake.ask.mock.lastCall).toEqual(['within', { region: { kind: 'all' }, crop: boxes[2] }]);
    expect(fake.inspecting().cropCount).toBeNull();
    answers[1]([Uint32Array.of(0b11)]);
    await expect.poll(() => fake.inspecting().cropCount).toBe(2);
  });

  it('begins around all splats, and goes to what the first view looks at and to what is seen', async () => {
    const fake = fakeTools();
    const cropping = new Cropping(fake.tools, new EditHistory(fake.tools));
    cropping.begin();
    await cropping.cropToView();
    expect(fake.inspecting().crop).toBeNull();
    const cloud = {
      count: 1,
      bounds: { min: [0, 0, 0], max: [2, 3, 4] },
      robustBounds: { min: [1, 1, 1], max: [1, 2, 2] },
    };
    Object.assign(fake.viewer.scenes, { newest: { parts: [], clouds: [{ cloud }] } });
    fake.ask.mockResolvedValue([Uint32Array.of(1)]);
    cropping.begin();
    const isKeptAt = (...center: [number, number, number]) => isKept(fake.inspecting().crop!, center);
    expect([isKeptAt(0, 0, 0), isKeptAt(2, 3, 4), isKeptAt(2, 3, 4.1)]).toEqual([true, true, false]);
    cropping.cropToSubject();
    expect([isKeptAt(0, 1, 2), isKeptAt(2, 3, 4), isKeptAt(1, 0.9, 3)]).toEqual([true, true, false]);
    fake.store.setState({ isFlipped: true });
    cropping.cropToSubject();
    // The first view looks at the other side of y and z then, where no splat is.
    expect([isKeptAt(1, 0, 0), isKeptAt(1, 1, 1)]).toEqual([false, false]);
    cropping.begin();
    expect(isKeptAt(2, 3, 4)).toBe(true);
    const camera = perspectiveCamera({ position: [0, 0, 5], target: [0, 0, 0], aspect: 1, fovYDegrees: 50 });
    Object.assign(fake.viewer, { shownFrame: { frame: { camera } } });
    const seen = { min: [0, 1, 2], max: [1, 2, 3] };
    fake.ask.mockImplementation(async (about) => (about === 'seen' ? seen : undefined));
    await cropping.cropToView();
    expect(fake.inspecting().crop).toEqual({ min: [0, 1, 2], max: [1, 2, 3], keep: 'inside' });
    fake.ask.mockResolvedValue(null);
    await cropping.cropToView();
    expect(fake.inspecting().problem).toContain('No splat');
  });

  it('has sliders whose steps are finest around the subject', () => {
    const fake = fakeTools();
    const cropping = new Cropping(fake.tools, new EditHistory(fake.tools));
    expect(cropping.place.center).toEqual([1, 2, 3]);
    fake.store.setState({ isFlipped: true });
    expect(cropping.place.center).toEqual([1, -2, -3]);
  });
});
