import { describe, expect, test, vi } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { type Accuracy, type FrameRasterizer, internAccuracy } from '../../data/accuracy/accuracy.ts';
import { type Camera, perspectiveCamera } from '../../data/camera/camera.ts';
import { packCloud } from '../../data/packing/packed-cloud.ts';
import { antialias, fog, tint } from '../../gpu/effects/index.ts';
import type { RasterizeDepth } from '../../stages/quads/quads.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { FramePlanner } from './frame-planner.ts';
import type { CloudInstance, FrameRequest } from './frame-request.ts';

const SET = randomSplats({ count: 500, seed: 3, shDegree: 1 });
const DEPTH: RasterizeDepth = {
  mapping: 'projection',
  compare: 'less-equal',
  isOrthographic: false,
  isTested: true,
  layerFormat: null,
};

function cloudOf(members: Partial<SplatCloud> = {}): SplatCloud {
  const planes = {};
  return {
    ...packCloud(SET, { geometryPrecision: 'packed' }),
    name: 'garden',
    version: 0,
    shDegree: 1,
    visibleLimit: Number.POSITIVE_INFINITY,
    isPreview: false,
    pagesFor: () => planes,
    ...members,
  } as unknown as SplatCloud;
}

const CLOUD = cloudOf();

function cameraAt(z: number): Camera {
  return perspectiveCamera({ position: [0, 0, z], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
}

function requestOf(
  z: number,
  instance: Partial<CloudInstance> = {},
  more: Partial<FrameRequest> = {},
): FrameRequest {
  return { camera: cameraAt(z), clouds: [{ cloud: CLOUD, ...instance }], widthPx: 64, heightPx: 64, ...more };
}

function plannerWith(isReady = vi.fn(() => true)) {
  const facts = {
    dispatchRow: 65_535,
    sortDevice: { workgroupBytes: 16_384, isNarrow: false, ballots: null },
    ballots: null,
  };
  const planner = new FramePlanner(facts, { kind: 'image' }, isReady);
  const plan = (
    request: FrameRequest,
    faster: FrameRasterizer = 'tiles',
    accuracy: Accuracy = 'balanced',
    depth: RasterizeDepth | null = null,
  ) => planner.plan(request, { accuracy: internAccuracy(accuracy), depth, faster });
  const draw = (...frame: Parameters<typeof plan>) => {
    const planned = plan(...frame);
    planner.take(planned, 0);
    return planned;
  };
  return { planner, plan, draw, isReady };
}

describe('a plan', () => {
  test('has the shape of the last frame, the same object, until the shape changes', () => {
    const { plan, draw } = plannerWith();
    const { shape } = draw(requestOf(3));
    expect(plan(requestOf(3.1)).shape).toBe(shape);
    expect(plan(requestOf(3, { effects: [tint([1, 0.5, 0.5])] })).shape).not.toBe(shape);
  });

  test('says that the frame is drawn already where nothing has changed', () => {
    const { plan, draw } = plannerWith();
    expect(draw(requestOf(3))).toMatchObject({ isDrawn: false, keepsOrder: false });
    expect(plan(requestOf(3))).toMatchObject({ isDrawn: true, keepsOrder: true });
    expect(plan(requestOf(3.1))).toMatchObject({ isDrawn: false, keepsOrder: false });
    expect(plan(requestOf(3, {}, { force: true }))).toMatchObject({ isDrawn: false, keepsOrder: false });
    expect(plan(requestOf(3), 'tiles', 'balanced', DEPTH)).toMatchObject({
      isDrawn: false,
      keepsOrder: true,
    });
  });

  test('keeps the order where only colours have changed, by the same rasteriser', () => {
    const { plan, draw } = plannerWith();
    draw(requestOf(3, { effects: [tint([1, 0.5, 0.5])] }));
    const tinted = requestOf(3, { effects: [tint([0.5, 1, 0.5])] });
    expect(plan(tinted)).toMatchObject({ isDrawn: false, keepsOrder: true });
    expect(plan(tinted, 'quads')).toMatchObject({ isDrawn: false, keepsOrder: false });
  });

  test('says that the frame is drawn already whichever rasteriser is the faster by now', () => {
    const { plan, draw, isReady } = plannerWith(vi.fn(() => false));
    draw(requestOf(3), 'tiles');
    expect(plan(requestOf(3), 'quads').isDrawn).toBe(true);
    expect(isReady).not.toHaveBeenCalled();
  });

  test('that is drawn already may be kept for its request, but not for a rasteriser that has drawn nothing', () => {
    const { plan, draw, planner } = plannerWith();
    draw(requestOf(3, { effects: [tint([1, 0.5, 0.5])] }), 'tiles');
    const same = { ...requestOf(3, { effects: [tint([1, 0.5, 0.5])] }), detail: { maxSplats: 1e9 } };
    planner.keep(plan(same, 'quads'));
    expect(planner.last!.request.detail).toEqual({ maxSplats: 1e9 });
    expect(planner.last!.shape.rasterizer).toBe('tiles');
    const tinted = requestOf(3, { effects: [tint([0.5, 1, 0.5])] });
    expect(plan(tinted, 'quads')).toMatchObject({ isDrawn: false, keepsOrder: false });
  });

  test('owns copies of objects that callers may change', () => {
    const { plan } = plannerWith();
    const request = requestOf(3, { modelMatrix: new Float64Array(16).fill(1) });
    const planned = plan(request);
    (request.camera.viewMatrix as Float64Array).fill(7);
    (request.clouds[0].modelMatrix as Float64Array).fill(7);
    expect(planned.camera.viewMatrix[0]).not.toBe(7);
    expect(planned.request.clouds[0].modelMatrix?.[0]).toBe(1);
  });
});

describe('where the rasteriser is chosen', () => {
  test('the last one goes on until the shaders of the faster are compiled', () => {
    const isReady = vi.fn(() => false);
    const { plan, draw } = plannerWith(isReady);
    expect(draw(requestOf(3), 'tiles').shape.rasterizer).toBe('tiles');
    expect(isReady).not.toHaveBeenCalled();
    expect(plan(requestOf(4), 'quads').shape.rasterizer).toBe('tiles');
    expect(isReady).toHaveBeenCalledWith(expect.objectContaining({ rasterizer: 'quads', binCount: 0 }));
    isReady.mockReturnValue(true);
    expect(plan(requestOf(4), 'quads').shape.rasterizer).toBe('quads');
  });

  test('an accuracy that names one has it at once', () => {
    const { plan, draw, isReady } = plannerWith(vi.fn(() => false));
    draw(requestOf(3), 'tiles');
    expect(plan(requestOf(4), 'tiles', { rasterizer: 'quads' }).shape.rasterizer).toBe('quads');
    expect(isReady).not.toHaveBeenCalled();
  });

  test('quads draw frames that write depth in half floats, which compute shaders cannot', () => {
    const { plan } = plannerWith();
    const written = { ...DEPTH, layerFormat: 'r16float' } as const;
    expect(plan(requestOf(3), 'tiles', { rasterizer: 'tiles' }, written).shape.rasterizer).toBe('quads');
  });
});

describe('a stopgap', () => {
  const ALL = [DEPTH, null];

  test('has the new camera, and the settings, effects and depth test of the last frame', () => {
    const { planner, plan, draw } = plannerWith();
    const effects = [tint([1, 0.5, 0.5])];
    const last = draw(requestOf(3, { effects, opacity: 0.5 }), 'tiles', 'fast');
    const fogged = [fog({ color: [0, 0, 0], near: 1, far: 9 })];
    const asked = plan(requestOf(4, { effects: fogged }), 'tiles', 'high', DEPTH);
    const stopgap = planner.planStopgap(asked, ALL)!;
    expect(stopgap.shape).toBe(last.shape);
    expect(stopgap.request.clouds).toEqual([{ cloud: CLOUD, effects, opacity: 0.5, shDegree: undefined }]);
    expect(stopgap.camera.viewMatrix).toEqual(asked.camera.viewMatrix);
    expect(stopgap.isDrawn).toBe(false);
  });

  test('is drawn already where only what lacks shaders has changed, even if the frame is forced', () => {
    const { planner, plan, draw } = plannerWith();
    draw(requestOf(3));
    const asked = plan(requestOf(3, { effects: [antialias()] }, { force: true }));
    expect(planner.planStopgap(asked, ALL)).toMatchObject({ isDrawn: true });
  });

  test('is the last frame itself where that had a preview, and none for other clouds', () => {
    const { planner, plan, draw } = plannerWith();
    expect(planner.planStopgap(plan(requestOf(3)), ALL)).toBeNull();
    const preview = draw(requestOf(3, { cloud: cloudOf({ isPreview: true }) }));
    expect(planner.planStopgap(plan(requestOf(3)), ALL)).toBe(preview);
    draw(requestOf(3, { cloud: cloudOf() }));
    expect(planner.planStopgap(plan(requestOf(3)), ALL)).toBeNull();
  });

  test('is none with a depth test that the view may not have', () => {
    const { planner, plan, draw } = plannerWith();
    draw(requestOf(3), 'tiles', 'balanced', DEPTH);
    const asked = plan(requestOf(4, { effects: [antialias()] }));
    expect(planner.planStopgap(asked, [null])).toBeNull();
    expect(planner.planStopgap(asked, ALL)?.shape.depth).toBe(DEPTH);
  });
});

describe('frames before', () => {
  test('keep keys as wide as they needed a moment ago, until the view starts over', () => {
    const { planner, plan, draw } = plannerWith();
    // Close to the splats, depths differ in more bits.
    const wide = draw(requestOf(0.1)).shape.keyBits;
    const narrow = plan(requestOf(100)).needs.depthBits;
    expect(narrow).toBeLessThan(wide);
    expect(plan(requestOf(100)).shape.keyBits).toBe(wide);
    expect(plan(requestOf(100, { cloud: cloudOf() })).shape.keyBits).toBe(narrow);
    planner.forget();
    expect(planner.last).toBeNull();
    expect(plan(requestOf(100)).shape.keyBits).toBe(narrow);
  });

  test('by wide keys leave others as narrow as they are', () => {
    const { plan, draw } = plannerWith();
    const narrow = plan(requestOf(100)).shape.keyBits;
    expect(draw(requestOf(100), 'tiles', 'reference').shape.keyBits).toBe(56);
    expect(plan(requestOf(100)).shape.keyBits).toBe(narrow);
  });
});
