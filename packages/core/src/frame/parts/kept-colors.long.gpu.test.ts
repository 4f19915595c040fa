import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, beforeEach, describe, expect, vi } from 'vitest';
import type { AccuracyPreset } from '../../accuracy/accuracy.ts';
import { type Camera, perspectiveCamera } from '../../camera/camera.ts';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import { defineEffect, tint } from '../../effects/index.ts';
import type { Vec3 } from '../../math/mat4.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import type { SplatView } from '../../views/splat-view.ts';
import type { CloudInstance, FrameRequest } from '../frame-request.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const SET = randomSplats({ count: 1500, seed: 70, shDegree: 2, logScales: [-4.5, -2.5] });

/** A camera that looks at the cloud, rolled by quarter turns about its line of sight: all turns show the same splats. */
function camera(quarters: number, position: Vec3 = [0.3, -0.2, 3]): Camera {
  const up = (
    [
      [0, 1, 0],
      [1, 0, 0],
      [0, -1, 0],
      [-1, 0, 0],
    ] as const
  )[quarters % 4];
  return perspectiveCamera({
    position,
    target: [position[0], position[1], 0],
    up,
    fovYDegrees: 50,
    aspect: 1,
    near: 0.1,
    far: 100,
  });
}

let device: GPUDevice;
let engine: SplatEngine;
/** Labels of the recorded passes. */
const passes: string[] = [];

beforeAll(async () => {
  device = await shareTestDevice();
  const createEncoder = device.createCommandEncoder.bind(device);
  device.createCommandEncoder = (descriptor) => {
    const encoder = createEncoder(descriptor);
    const { beginComputePass, beginRenderPass } = encoder;
    encoder.beginComputePass = (pass) => {
      passes.push(pass?.label ?? '');
      return beginComputePass.call(encoder, pass);
    };
    encoder.beginRenderPass = (pass) => {
      passes.push(pass.label ?? '');
      return beginRenderPass.call(encoder, pass);
    };
    return encoder;
  };
  // Frames are compared bit by bit, so the rasteriser must not change between them.
  engine = await SplatEngine.create({ device, accuracy: { rasterizer: 'tiles' } });
});
afterAll(() => {
  engine?.destroy();
  device?.destroy();
});
beforeEach(() => {
  passes.length = 0;
});

async function draw(
  view: SplatView,
  frame: Omit<FrameRequest, 'widthPx' | 'heightPx'>,
): Promise<Float32Array> {
  view.render({ ...SIZE, ...frame });
  return (await view.readPixels()).data;
}

/** Returns the image of a new view. */
async function drawAnew(frame: Omit<FrameRequest, 'widthPx' | 'heightPx'>): Promise<Float32Array> {
  const view = engine.createView();
  const data = await draw(view, frame);
  view.destroy();
  return data;
}

/** Moves about until the shaders that keep colours have been compiled in the background. */
async function warmUp(
  view: SplatView,
  frame: Omit<FrameRequest, 'widthPx' | 'heightPx' | 'camera'>,
): Promise<void> {
  for (let i = 0; i < 200 && !view.shape?.clouds[0].keepsColors; i++) {
    await draw(view, { ...frame, camera: camera(i, [0, 0, 4]) });
    await new Promise((resolve) => setTimeout(resolve, 10));
  }
  expect(view.shape?.clouds.map(({ keepsColors }) => keepsColors)).toEqual([true]);
}

const SPOIL = `
  @group(0) @binding(0) var<storage, read_write> words: array<u32>;
  @compute @workgroup_size(64)
  fn spoil(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < arrayLength(&words)) { words[id.x] = 0x35353535u; }
  }`;

/** Overwrites the harmonics, so that colours evaluated from now on are wrong. */
function spoilHarmonics(cloud: SplatCloud, settings = engine.accuracy): void {
  const module = device.createShaderModule({ code: SPOIL });
  const pipeline = device.createComputePipeline({ layout: 'auto', compute: { module } });
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginComputePass();
  pass.setPipeline(pipeline);
  for (const { shRest } of cloud.pagesFor(settings).pages) {
    const entries = [{ binding: 0, resource: { buffer: shRest! } }];
    pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }));
    pass.dispatchWorkgroups(Math.ceil(shRest!.size / 4 / 64));
  }
  pass.end();
  device.queue.submit([encoder.finish()]);
}

/** Moves splats. */
const sway = defineEffect<number, { by: 'f32' }>({
  name: 'sway',
  label: 'Sway',
  about: 'Moves splats along x.',
  hooks: { splat: 'sway' },
  wgsl: `
    import package::lib::packing::Splat;
    import parameters::Sway;
    fn sway(splat: Splat, splatIndex: u32, parameters: Sway) -> Splat {
      var moved = splat;
      moved.position.x += parameters.by;
      return moved;
    }`,
  fields: { by: 'f32' },
  calledFor: () => 'there is wind',
  valuesAt: (by) => ({ by }),
  reach: (by) => ({ displacement: Math.abs(by), growth: 1 }),
});

/** Changes the base colours that splats' colours are evaluated from. */
const dye = defineEffect<number, { by: 'f32' }>({
  name: 'dye',
  label: 'Dye',
  about: 'Makes splats redder.',
  hooks: { splat: 'dye' },
  wgsl: `
    import package::lib::packing::Splat;
    import parameters::Dye;
    fn dye(splat: Splat, splatIndex: u32, parameters: Dye) -> Splat {
      var dyed = splat;
      dyed.colorDc.x += parameters.by;
      return dyed;
    }`,
  fields: { by: 'f32' },
  calledFor: () => 'there is dye',
  valuesAt: (by) => ({ by }),
});

/** Passes `count` values to a parameter that takes three. */
const fade = defineEffect<number, { factors: 'vec3f' }>({
  name: 'fade',
  label: 'Fade',
  about: 'Makes splats fainter.',
  hooks: { opacity: 'fade' },
  wgsl: `
    import package::lib::visible_ellipse::ScreenSplat;
    import parameters::Fade;
    fn fade(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32, parameters: Fade) -> f32 {
      return opacity * parameters.factors.x;
    }`,
  fields: { factors: 'vec3f' },
  calledFor: () => 'it is told to',
  valuesAt: (count) => ({ factors: Array<number>(count).fill(0.5) }),
});

/** Any expression of `color`, in a shader that no other test has compiled. */
const colored = (name: string, expression: string) =>
  defineEffect<void>({
    name,
    label: name,
    about: 'Changes colours.',
    hooks: { color: name },
    wgsl: `
      import package::lib::packing::Splat;
      fn ${name}(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f) -> vec3f {
        return ${expression};
      }`,
    calledFor: () => 'it is told to',
  });

const keptBytes = () =>
  engine
    .memory()
    .resources.reduce((sum, { label, bytes }) => sum + (label === 'frame kept colors' ? bytes : 0), 0);

describe('colours', () => {
  for (const preset of ['balanced', 'reference', 'paper'] as const satisfies readonly AccuracyPreset[]) {
    const accuracy = { preset, rasterizer: preset === 'paper' ? 'quads' : 'tiles' } as const;
    gpuTest(
      `${preset}: are kept while the camera turns in place, and no harmonics are read again`,
      async () => {
        const cloud = engine.add(SET);
        await engine.requestPrecision(cloud, engine.resolveAccuracy(accuracy).settings);
        const view = engine.createView();
        const clouds = [{ cloud }];
        await warmUp(view, { clouds, accuracy });
        const expected: Float32Array[] = [];
        for (let i = 0; i < 4; i++) expected.push(await drawAnew({ camera: camera(i), clouds, accuracy }));

        expect(await draw(view, { camera: camera(0), clouds, accuracy })).toEqual(expected[0]);
        // All visible splats have been evaluated: evaluating one again would change its colour.
        spoilHarmonics(cloud, engine.resolveAccuracy(accuracy).settings);
        expect(await drawAnew({ camera: camera(1), clouds, accuracy })).not.toEqual(expected[1]);
        for (let i = 1; i < 9; i++)
          expect(await draw(view, { camera: camera(i), clouds, accuracy })).toEqual(expected[i % 4]);
        expect(keptBytes()).toBe((preset === 'reference' ? 16 : 8) * (cloud.count + 1));

        // From another place, colours differ, and the old ones are not used.
        const elsewhere = camera(0, [0.3, -0.2, 3.001]);
        expect(await draw(view, { camera: elsewhere, clouds, accuracy })).toEqual(
          await drawAnew({ camera: elsewhere, clouds, accuracy }),
        );
        view.destroy();
        cloud.destroy();
        expect(keptBytes()).toBe(0);
      },
    );
  }

  gpuTest('free their memory after two seconds of moving about', async () => {
    const cloud = engine.add(randomSplats({ count: 10 }));
    const view = engine.createView();
    const clouds = [{ cloud }];
    await warmUp(view, { clouds });
    expect(keptBytes()).toBeGreaterThan(0);
    // Nobody looks at the frames before the last.
    const undrawn = vi.spyOn(device.queue, 'submit').mockReturnValue(undefined);
    for (let i = 0; i < 121; i++) view.render({ camera: camera(0, [0, 0, 2 + i / 100]), clouds, ...SIZE });
    undrawn.mockRestore();
    view.render({ camera: camera(0, [0, 0, 2 + 121 / 100]), clouds, ...SIZE });
    await view.readPixels();
    expect(keptBytes()).toBe(0);
    const turned = { camera: camera(1, [0, 0, 2 + 121 / 100]), clouds };
    expect(await draw(view, turned)).toEqual(await drawAnew(turned));
    expect(keptBytes()).toBeGreaterThan(0);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('are evaluated once for a place, also for splats that come into sight later', async () => {
    const cloud = engine.add(SET);
    const view = engine.createView();
    const clouds = [{ cloud }];
    const position: Vec3 = [0, 0, 2];
    const turned = (angle: number) =>
      perspectiveCamera({
        position,
        target: [Math.sin(angle), 0, 2 - Math.cos(angle)],
        fovYDegrees: 30,
        aspect: 1,
        near: 0.1,
        far: 100,
      });
    await warmUp(view, { clouds });
    const angles = [0, 0.1, 0.2, 0.3, 0.2, 0.1, 0];
    for (const angle of angles)
      expect(await draw(view, { camera: turned(angle), clouds })).toEqual(
        await drawAnew({ camera: turned(angle), clouds }),
      );
    const expected = await Promise.all(
      [0, 0.2, 0.3].map((angle) => drawAnew({ camera: turned(angle), clouds })),
    );
    spoilHarmonics(cloud);
    for (const [i, angle] of [0, 0.2, 0.3].entries())
      expect(await draw(view, { camera: turned(angle), clouds })).toEqual(expected[i]);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('are updated without culling or sorting if only they have changed', async () => {
    const cloud = engine.add(SET);
    const view = engine.createView();
    const reddish = (red: number) => ({
      camera: camera(0),
      clouds: [{ cloud, effects: [tint([red, 0.5, 0.5])] }],
    });
    await draw(view, reddish(0.1));
    await draw(view, reddish(0.2));
    const expected = await drawAnew(reddish(0.9));
    // Effects act on kept colours too.
    spoilHarmonics(cloud);
    passes.length = 0;
    expect(await draw(view, reddish(0.9))).toEqual(expected);
    expect(passes).toEqual(['pre-process', 'tiles', 'rasterize']);
    view.destroy();
    cloud.destroy();
  });
});

describe('colours are not taken', () => {
  gpuTest('from another page, when a cloud moves among the pages of the frame', async () => {
    const cloud = engine.add(SET);
    // One without a page, and one with a page.
    const inFront = [0, 700].map((count) => engine.add(randomSplats({ count, seed: 5, shDegree: 2 })));
    const view = engine.createView();
    const frame = (pages: number, quarters: number, z: number) => ({
      camera: camera(quarters, [0, 0, z]),
      clouds: [{ cloud: inFront[pages] }, { cloud }],
    });
    await warmUp(view, { clouds: [{ cloud }] });
    await draw(view, frame(0, 0, 3));
    await draw(view, frame(0, 1, 3));
    expect(view.shape?.clouds[1].keepsColors).toBe(true);
    const moved = frame(1, 2, 3);
    expect(await draw(view, moved)).toEqual(await drawAnew(moved));
    // The same while colours are only in the records, not kept yet.
    await draw(view, frame(1, 0, 3.1));
    const movedBack = frame(0, 1, 3.1);
    expect(await draw(view, movedBack)).toEqual(await drawAnew(movedBack));
    for (const thing of [view, cloud, ...inFront]) thing.destroy();
  });

  gpuTest('from splats that callers’ effects have changed', async () => {
    const cloud = engine.add(SET);
    const view = engine.createView();
    await warmUp(view, { clouds: [{ cloud }] });
    // The effect has moved the splats away from their stored positions.
    await draw(view, { camera: camera(0, [0, 0, 2]), clouds: [{ cloud, effects: [sway(0.8)] }] });
    const plain = { camera: camera(1, [0, 0, 2]), clouds: [{ cloud }] };
    expect(await draw(view, plain)).toEqual(await drawAnew(plain));
    // The effect has changed the stored colours.
    const dyed = { camera: camera(2, [0, 0, 2]), clouds: [{ cloud, effects: [dye(0.4)] }] };
    expect(await draw(view, dyed)).toEqual(await drawAnew(dyed));
    view.destroy();
    cloud.destroy();
  });

  gpuTest('at 8 bits and up to 1 if effects act on them', async () => {
    const cloud = engine.add(SET);
    const view = engine.createView();
    const clouds = [{ cloud }];
    const darker = [{ cloud, effects: [tint([0.4, 0.4, 0.4])] }];
    await warmUp(view, { clouds, accuracy: 'paper' });
    await draw(view, { camera: camera(0), clouds, accuracy: 'paper' });
    await draw(view, { camera: camera(1), clouds, accuracy: 'paper' });
    const frame = { camera: camera(1), clouds: darker, accuracy: 'paper' } as const;
    // The evaluated one comes last: once shaders without kept colours are compiled, views do not wait for those with them.
    const afterTurn = await draw(view, frame);
    const atOnce = await drawAnew(frame);
    const evaluated = await drawAnew({ ...frame, force: true });
    expect(afterTurn).toEqual(evaluated);
    expect(atOnce).toEqual(evaluated);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('from a frame that could not be drawn', async () => {
    const cloud = engine.add(SET);
    const view = engine.createView();
    const fading = (values: number, z: number) => ({
      camera: camera(0, [0, 0, z]),
      clouds: [{ cloud, effects: [fade(values)] }],
    });
    await warmUp(view, { clouds: [{ cloud }] });
    await draw(view, fading(3, 3.5));
    await draw(view, { camera: camera(0, [0, 0, 3]), clouds: [{ cloud }] });
    // The parameter takes three values: the frame fails, and its place must not count as the last frame's.
    expect(() => view.render({ ...SIZE, ...fading(2, 2) })).toThrow(/takes 3 values/);
    const turned = { camera: camera(1, [0, 0, 2]), clouds: [{ cloud }] };
    expect(await draw(view, turned)).toEqual(await drawAnew(turned));
    view.destroy();
    cloud.destroy();
  });
});

gpuTest('an unchanged frame takes no passes', async () => {
  const cloud = engine.add(SET);
  const view = engine.createView();
  const frame = {
    camera: camera(0),
    clouds: [{ cloud, opacity: 0.7, effects: [tint([1, 0.5, 0.5])] }],
    ...SIZE,
  };
  view.render(frame);
  await view.whenDrawn();
  passes.length = 0;
  for (let i = 0; i < 100; i++) expect(view.render({ ...frame, camera: camera(0) })).toBe(false);
  expect(passes).toEqual([]);
  view.destroy();
  cloud.destroy();
});

describe('a view', () => {
  gpuTest('notices changes that callers make in the objects that they passed', async () => {
    const cloud = engine.add(SET);
    const other = engine.add(randomSplats({ count: 100, shDegree: 3 }));
    const view = engine.createView();
    const background: [number, number, number] = [0, 0, 0];
    const clouds: CloudInstance[] = [{ cloud }];
    const frame = { ...SIZE, camera: camera(0), clouds, background };
    await draw(view, frame);
    expect(view.render(frame)).toBe(false);
    background[0] = 1;
    expect(view.render(frame)).toBe(true);

    const before = view.effects();
    clouds.push({ cloud: other, effects: [tint([1, 0, 0.5])] });
    expect(view.effects()).toEqual(before);
    expect(await draw(view, frame)).toEqual(await drawAnew(frame));
    for (const thing of [view, cloud, other]) thing.destroy();
  });

  gpuTest('tells infinite values apart', async () => {
    const cloud = engine.add(SET);
    const view = engine.createView();
    const dyed = (by: number) => ({ ...SIZE, camera: camera(0), clouds: [{ cloud, effects: [dye(by)] }] });
    for (const by of [Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY]) {
      expect(view.render(dyed(by))).toBe(true);
      await view.whenDrawn();
      expect(view.render(dyed(by))).toBe(false);
    }
    view.destroy();
    cloud.destroy();
  });

  gpuTest('goes on after shaders that do not compile', async () => {
    const cloud = engine.add(SET);
    const view = engine.createView();
    const plain = { ...SIZE, camera: camera(0), clouds: [{ cloud }] };
    await draw(view, plain);
    device.pushErrorScope('validation');
    const broken = colored('broken', 'color * vec2f(1.0)')();
    view.render({ ...plain, clouds: [{ cloud, effects: [broken] }] });
    const failing = view.whenDrawn();
    // This frame is drawn at once; the next one is still waiting when the first fails.
    view.render({ ...plain, camera: camera(1) });
    await view.whenDrawn();
    const later = { ...plain, clouds: [{ cloud, effects: [colored('later', 'color * 0.25')()] }] };
    view.render(later);
    await expect(failing).rejects.toThrow();
    expect((await view.readPixels()).data).toEqual(await drawAnew(later));
    // A failed frame does not block a frame that is already shown.
    view.render({ ...later, clouds: [{ cloud, effects: [broken] }] });
    await expect(view.whenDrawn()).rejects.toThrow();
    expect(view.render(later)).toBe(false);
    await view.whenDrawn();
    expect(await device.popErrorScope()).not.toBeNull();
    view.destroy();
    cloud.destroy();
  });
});
