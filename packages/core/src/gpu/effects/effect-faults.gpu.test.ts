// Proves: an effect with an error is named, once, and everything else is drawn on.
import { createNodeGpu } from '@websplatter/node';
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, beforeEach, describe, expect } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import { DestroyedError, InvalidArgumentError, ShaderError } from '../../data/errors.ts';
import type { CloudInstance } from '../../frame/plan/frame-request.ts';
import { compareImages } from '../../reference/index.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testCameras } from '../../testing/test-cameras.ts';
import type { EmbeddedView } from '../../views/embedded-view.ts';
import type { SplatView } from '../../views/splat-view.ts';
import { defineEffect } from './define-effect.ts';
import type { EffectUse } from './effect.ts';
import { effectResources } from './effect-resources.ts';
import { tint } from './tint/tint.ts';

const SIZE = { widthPx: 32, heightPx: 32 };
const { perspective: camera } = testCameras(1);
const SET = randomSplats({ count: 100, seed: 5, shDegree: 0, logScales: [-3.5, -2] });
const HEAD = 'import package::lib::packing::Splat;\n';
const COLOR = '(color: vec3f, splat: Splat, index: u32, centerView: vec3f) -> vec3f';

/** An effect of a caller that changes colours. */
function own(name: string, wgsl: string, hooks: object = { color: 'own' }): EffectUse {
  const calledFor = () => 'a test wants it';
  return defineEffect({ name, label: name, about: 'Changes colours.', hooks, wgsl, calledFor })();
}
const right = (name: string) => own(name, `${HEAD}fn own${COLOR} { return color.bgr; }`);

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
let cloud: SplatCloud;
beforeAll(async () => {
  device = await shareTestDevice();
});
beforeEach(async () => {
  engine = await SplatEngine.create({ device, accuracy: 'high' });
  view = engine.createView();
  cloud = engine.add(SET, { name: 'garden' });
  return () => engine.destroy();
});

const frame = (clouds: CloudInstance[]) => ({ camera, clouds, ...SIZE });
const withEffects = (...effects: EffectUse[]) => frame([{ cloud, effects }]);

async function pictureOf(clouds: CloudInstance[]): Promise<Float32Array> {
  const other = engine.createView();
  other.render(frame(clouds));
  const { data } = await other.readPixels();
  other.destroy();
  return data as Float32Array;
}

async function expectPicture(clouds: CloudInstance[]) {
  const { psnrDb } = compareImages((await view.readPixels()).data, await pictureOf(clouds), SIZE);
  expect(psnrDb).toBeGreaterThan(100);
}

describe('an effect whose shader has an error', () => {
  // What is wrong, its WGSL, the line of the error in it, and what the message has.
  const wrong: [string, string, number, RegExp][] = [
    [
      'imports a module that is none',
      `${HEAD}import package::lib::nothing::here;\nfn own${COLOR} { here(); return color; }`,
      2,
      /there is no module package::lib::nothing/,
    ],
    [
      'imports a name that is none',
      `import package::lib::packing::{Splat, nothing};\nfn own${COLOR} { nothing(); return color; }`,
      1,
      /declares no "nothing"/,
    ],
    [
      'declares a name twice',
      `${HEAD}const A = 1;\nconst A = 2;\nfn own${COLOR} { return color; }`,
      3,
      /"A" is declared/,
    ],
    ['lacks its hook', `${HEAD}fn other${COLOR} { return color; }`, 1, /declares no "own"/],
    [
      'uses a value that is none',
      `${HEAD}fn own${COLOR} {\n  let x = 1.0;\n  return wibble * color;\n}`,
      4,
      /wibble/,
    ],
    ['has a syntax error', `${HEAD}fn own${COLOR} {\n  return color +;\n}`, 3, /./],
    [
      'returns another type',
      `${HEAD}fn own(color: vec3f, splat: Splat, index: u32, centerView: vec3f) -> vec2f { return color.xy; }`,
      0,
      /vec2/,
    ],
    [
      'takes other arguments',
      `${HEAD}fn own(color: vec3f) -> vec3f { return color; }`,
      0,
      /argument|parameter|call/i,
    ],
    [
      'begins no declaration',
      `${HEAD}enable f16;\nfn own${COLOR} { return color; }`,
      2,
      /begins no declaration/,
    ],
  ];
  for (const [what, wgsl, line, message] of wrong) {
    /**
     * @fault Effects: the WGSL of a caller's effect cannot be linked or compiled
     * @consequence one ShaderError names effect, module, line and WGSL's message; the cloud is drawn without it
     */
    gpuTest(`is named, and left out: it ${what}`, async () => {
      const bad = own('wind-sway', wgsl);
      view.render(withEffects(tint([1, 0, 0]), bad));
      const error = await view.whenDrawn().then(
        () => null,
        (reason) => reason,
      );
      expect(error).toBeInstanceOf(ShaderError);
      expect(error.code).toBe('shader');
      expect(error.effects).toEqual(['wind-sway']);
      expect(error.message).toMatch(message);
      expect(error.message).toContain('The effect wind-sway cannot be drawn');
      if (line > 0) {
        expect(error.module).toMatch(/^(package::effects::wind_sway|effects)$/);
        if (error.module !== 'effects') expect(error.line).toBe(line);
        expect(error.message).toContain(`${error.module}, line ${error.line}`);
      }
      // Once by the next call, then never again.
      expect(() => view.render(withEffects(tint([1, 0, 0]), bad))).toThrow(error);
      view.render(withEffects(tint([1, 0, 0]), bad));
      await expectPicture([{ cloud, effects: [tint([1, 0, 0])] }]);
      const entry = view.effects().find(({ name }) => name === 'wind-sway');
      expect(entry).toMatchObject({ isOn: false, reason: expect.stringContaining(error.message) });
      // Later changes are drawn, and the mended effect.
      view.render(withEffects(tint([0, 1, 0]), bad));
      await expectPicture([{ cloud, effects: [tint([0, 1, 0])] }]);
      view.render(withEffects(tint([0, 1, 0]), right('wind-sway')));
      await expectPicture([{ cloud, effects: [tint([0, 1, 0]), right('mended')] }]);
    });
  }

  gpuTest('leaves other clouds, and other effects of the cloud, as they are', async () => {
    const other = engine.add(randomSplats({ count: 80, seed: 6, shDegree: 0, logScales: [-3, -2] }));
    const bad = [
      own('bad-a', `${HEAD}fn own${COLOR} { return a; }`),
      own('bad-b', `${HEAD}fn own${COLOR} { return b; }`),
    ];
    const clouds = [
      { cloud, effects: [bad[0], right('fine'), bad[1]] },
      { cloud: other, effects: [right('fine')] },
    ];
    const names: string[] = [];
    view.render(frame(clouds));
    for (let i = 0; i < 3; i++) {
      await view.whenDrawn().catch(() => {});
      try {
        view.render(frame(clouds));
      } catch (error) {
        names.push(...(error as ShaderError).effects);
      }
    }
    expect(names.sort()).toEqual(['bad-a', 'bad-b']);
    view.render(frame(clouds));
    const fine = right('also-fine');
    await expectPicture([
      { cloud, effects: [fine] },
      { cloud: other, effects: [fine] },
    ]);
  });

  gpuTest('is told to the listener of an embedded view, with its clouds, once', async () => {
    const embedded = engine.createEmbeddedView();
    const other = engine.add(SET, { name: 'other' });
    const bad = own('bad', `${HEAD}fn own${COLOR} { return nothing; }`);
    const told: unknown[] = [];
    embedded.onFault = (error, clouds) => told.push([error, clouds.map(({ name }) => name)]);
    const request = frame([{ cloud, effects: [bad] }, { cloud: other }]);
    await untilPrepared(embedded, request, []);
    const clouds = [{ cloud, effects: [bad, tint([0.5, 0.5, 0.5])] }, { cloud: other }];
    await untilPrepared(embedded, frame(clouds), ['tint']);
    expect(told).toEqual([[expect.any(ShaderError), ['garden']]]);
    embedded.destroy();
  });

  gpuTest('is thrown by an embedded view without a listener, once', async () => {
    const embedded = engine.createEmbeddedView();
    const bad = own('bad', `${HEAD}import package::lib::nothing::here;\nfn own${COLOR} { return here; }`);
    const errors = await untilPrepared(embedded, withEffects(bad), []);
    expect(errors).toEqual([expect.any(ShaderError)]);
    embedded.destroy();
  });
});

/** Prepares a request whenever the view asks for it, until it draws its first cloud with these effects. Returns what was thrown. */
async function untilPrepared(
  embedded: EmbeddedView,
  request: ReturnType<typeof frame>,
  drawn: readonly string[],
): Promise<unknown[]> {
  const errors: unknown[] = [];
  await new Promise<void>((resolve) => {
    const prepare = () => {
      try {
        if (!embedded.prepare(request)) return;
        const names = embedded.shape!.clouds[0].effects.linked.map(({ effect }) => effect.name);
        if (JSON.stringify(names) === JSON.stringify(drawn)) resolve();
      } catch (error) {
        errors.push(error);
      }
    };
    embedded.onReady = prepare;
    prepare();
  });
  return errors;
}

const painted = defineEffect<{ image?: GPUTexture; rows?: GPUBuffer }>({
  name: 'painted',
  label: 'Painted',
  about: 'Reads a texture and a buffer.',
  hooks: { color: 'paintColor' },
  resources: effectResources({ image: 'texels', rows: 'array<vec4f>' }, ({ image, rows }) => ({
    image: image!,
    rows: rows!,
  })),
  wgsl: `${HEAD}import parameters::{paintedImage, paintedRows};
fn paintColor${COLOR} { return textureLoad(paintedImage, vec2u(0u), 0).rgb + paintedRows[0].rgb; }`,
  calledFor: () => 'it is painted',
});
const imageOf = () =>
  device.createTexture({
    label: 'an image',
    size: [1, 1],
    format: 'rgba8unorm',
    usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
  });
const rowsOf = (size = 64) => device.createBuffer({ label: 'rows', size, usage: GPUBufferUsage.STORAGE });

describe('a resource that ends', () => {
  /**
   * @fault Effects: a texture or buffer of an effect is destroyed while it is drawn
   * @consequence a DestroyedError names effect and resource, once; clouds are drawn without the effect
   */
  for (const of of ['image', 'rows'] as const)
    for (const when of ['before its first frame', 'between frames'] as const)
      gpuTest(`is named, and its effect left out: ${of}, ${when}`, async () => {
        const resources = { image: imageOf(), rows: rowsOf() };
        const request = () => withEffects(painted(resources));
        if (when === 'between frames') {
          view.render(request());
          await view.whenDrawn();
        }
        resources[of].destroy();
        view.render({ ...request(), force: true });
        const error = await view.whenDrawn().then(
          () => null,
          (reason) => reason,
        );
        expect(error).toBeInstanceOf(DestroyedError);
        expect(error.message).toContain(`The resource ${of} of the effect painted`);
        expect(() => view.render(request())).toThrow(error);
        view.render(request());
        await expectPicture([{ cloud }]);
        // A new one is drawn again, and told again when it ends.
        Object.assign(resources, { image: imageOf(), rows: rowsOf() });
        view.render(request());
        await view.whenDrawn();
        expect(view.effects().find(({ name }) => name === 'painted')?.isOn).toBe(true);
        resources[of].destroy();
        view.render({ ...request(), force: true });
        await expect(view.whenDrawn()).rejects.toThrow(DestroyedError);
      });

  gpuTest('is told to an embedded view, whose other clouds go on', async () => {
    const embedded = engine.createEmbeddedView();
    const other = engine.add(SET, { name: 'other' });
    const resources = { image: imageOf(), rows: rowsOf() };
    const told: unknown[] = [];
    const request = () => frame([{ cloud, effects: [painted(resources)] }, { cloud: other }]);
    await untilPrepared(embedded, request(), ['painted']);
    resources.image.destroy();
    await new Promise<void>((resolve) => {
      embedded.onFault = (error, clouds) => {
        told.push([error, clouds.map(({ name }) => name)]);
        resolve();
      };
      embedded.onReady = () => embedded.prepare(request());
      embedded.prepare({ ...request(), force: true } as never);
    });
    expect(told).toEqual([[expect.any(DestroyedError), ['garden']]]);
    await untilPrepared(embedded, request(), []);
    embedded.destroy();
  });

  gpuTest('buffers without room for an element are refused by name', async () => {
    const act = () => view.render(withEffects(painted({ image: imageOf(), rows: rowsOf(12) })));
    expect(act).toThrow(InvalidArgumentError);
    expect(act).toThrow('rows has 12 bytes, and an element of array<vec4f> has 16');
  });

  gpuTest('resources of another device leave the picture of all else as it should be', async () => {
    const foreign = await (await createNodeGpu()).adapter.requestDevice();
    const image = foreign.createTexture({
      size: [1, 1],
      format: 'rgba8unorm',
      usage: GPUTextureUsage.TEXTURE_BINDING,
    });
    const request = withEffects(painted({ image, rows: rowsOf() }), tint([1, 0, 0]));
    view.render(request);
    const error = await view.whenDrawn().then(
      () => null,
      (reason) => reason,
    );
    expect(error).toBeInstanceOf(InvalidArgumentError);
    expect(error.message).toContain("image cannot be bound on the engine's device");
    expect(() => view.render(request)).toThrow(error);
    view.render(request);
    await expectPicture([{ cloud, effects: [tint([1, 0, 0])] }]);
    foreign.destroy();
  });
});
