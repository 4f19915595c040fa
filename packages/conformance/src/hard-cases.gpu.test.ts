// Proves: every case on Dawn, by stages and images; that the runner fails.
import { encodePly } from '@websplatter/core';
import { renderReference } from '@websplatter/core/reference';
import { createNodeGpu } from '@websplatter/node';
import { sharedTestGpu as gpu, gpuTest } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { HARD_CASES } from './catalogue.ts';
import type { HardCase, SceneCase } from './hard-case.ts';
import { frontOnly } from './make-cases.ts';
import { ordinarySplats, splatsOf } from './make-splats.ts';
import { HardCaseRunner, type HardCaseRunnerOptions, type HardCaseRunOptions } from './run.ts';
import { COMPARED_PRESETS } from './run-images.ts';
import { CASE_RASTERIZERS } from './run-result.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';
/** In the short run, some images of one preset and rasteriser show that frames do not differ. */
const repeats = isFull ? 'all' : 'few';
/** In the short run, images of coarser presets are left out where no bound is demanded of them. */
const presetsOf = (hardCase: HardCase) =>
  COMPARED_PRESETS.filter(
    (preset) => isFull || preset === 'reference' || ('bounds' in hardCase && hardCase.bounds?.[preset]),
  );
/** Time for the whole catalogue in software at 64×64, as the short run draws it. */
const BUDGET_MS = 90_000;

let runner: HardCaseRunner;
let elapsedMs = 0;
let processorMs = 0;
let casesRun = 0;
beforeAll(async () => {
  runner = await HardCaseRunner.create({ gpu });
});
afterAll(() => runner?.destroy());

describe('hard case', () => {
  gpuTest('names are unique', () => {
    expect(new Set(HARD_CASES.map(({ name }) => name)).size).toBe(HARD_CASES.length);
  });

  for (const [index, hardCase] of HARD_CASES.entries()) {
    gpuTest(hardCase.name, async () => {
      const before = process.cpuUsage();
      const turn = isFull ? undefined : index;
      const result = await runner.run(hardCase, { repeats, turn, presets: presetsOf(hardCase) });
      const { user, system } = process.cpuUsage(before);
      processorMs += (user + system) / 1000;
      elapsedMs += result.elapsedMs;
      casesRun++;
      if (result.verdict === 'fail') expect.fail(result.failures.join('\n'));
    });
  }

  gpuTest('all of them within the budget on a software adapter', ({ skip }) => {
    if (isFull || !runner.isSoftware || casesRun < HARD_CASES.length)
      skip('needs every case as the short run draws it, on a software adapter');
    // Other programs on the machine lengthen the elapsed time, but not the processor time: left
    // alone, the cases take no longer than either.
    expect(Math.min(elapsedMs, processorMs)).toBeLessThan(BUDGET_MS);
  });
});

/** A scene that passes. */
const SOUND: SceneCase = {
  kind: 'scene',
  name: 'sound',
  group: 'scale',
  breaks: 'Nothing.',
  clouds: () => [{ set: splatsOf(ordinarySplats()) }],
  cameras: frontOnly,
};

/** Runs a case that must fail, and returns its failures. */
async function failuresOf(hardCase: HardCase, options?: HardCaseRunOptions, by = runner): Promise<string> {
  const { verdict, failures } = await by.run(hardCase, options);
  expect(verdict).toBe('fail');
  return failures.join('\n');
}

describe('the runner', () => {
  gpuTest('measures how halves are rounded', async ({ skip }) => {
    if (!/swiftshader/.test(runner.adapterLabel))
      skip('only known of SwiftShader, which rounds to the nearest');
    expect(runner.isTruncating).toBe(false);
  });

  gpuTest('passes a sound scene', async () => {
    const { failures, worstStage, images } = await runner.run(SOUND);
    expect(failures).toEqual([]);
    expect(worstStage?.ratio).toBeLessThan(1);
    expect(Object.keys(images.quads)).toEqual(['reference', 'high', 'balanced']);
    // Without a bound, images are only reported, and one rasteriser suffices.
    expect(Object.keys(images.tiles)).toEqual(['reference']);
    const bounds = { high: { minPsnrDb: 50, cause: 'to see both rasterisers compared' } };
    const bounded = await runner.run({ ...SOUND, bounds });
    expect(Object.keys(bounded.images.tiles)).toEqual(['reference', 'high']);
    expect(bounded.failures).toEqual([]);
  });

  gpuTest('fails if other splats are dropped than the case states', async () => {
    const found = await failuresOf({ ...SOUND, dropped: { 'non-finite-scale': 2 } });
    expect(found).toBe('sound: left out nothing, expected non-finite-scale: 2');
  });

  gpuTest('fails if the image differs from float64, or misses a bound of its own', async () => {
    const ofAnotherScene: HardCaseRunnerOptions['renderReference'] = (frame) =>
      renderReference({ ...frame, clouds: [{ set: splatsOf(ordinarySplats(2)) }] });
    const doctored = await HardCaseRunner.create({ gpu, renderReference: ofAnotherScene });
    const found = await failuresOf(SOUND, {}, doctored);
    doctored.destroy();
    expect(found).toMatch(
      /^sound, camera front, reference, quads: [\d.]+ dB, expected at least 55 dB; worst at column /m,
    );
    expect(found).toMatch(/^sound, camera front, reference, tiles: [\d.]+ dB, expected at least 55 dB/m);
    const bounds = { balanced: { minPsnrDb: 200, cause: 'to see it fail' } };
    const missed = await failuresOf({ ...SOUND, bounds });
    for (const rasterizer of CASE_RASTERIZERS)
      expect(missed).toMatch(
        new RegExp(`^sound, camera front, balanced, ${rasterizer}: .* at least 200 dB`, 'm'),
      );
  });

  gpuTest('fails if a number in the records is not finite', async () => {
    const mutation = {
      file: 'stages/project',
      find: 'record.depthView = onScreen.depthView;',
      replace:
        'record.depthView = onScreen.depthView; record.majorPx.x = bitcast<f32>(0x7fc00000u | (index & 1u));',
    };
    const found = await failuresOf(SOUND, { mutation });
    expect(found).toMatch(/sound, camera front, reference: .* majorPx length: got NaN, expected/);
    expect(found).toMatch(/sound, camera front, reference: records: record 0, majorPx is NaN/);
  });

  for (const [rasterizer, infinite] of Object.entries({
    quads: {
      file: 'stages/rasterize',
      find: 'vec4f(color.rgb * alpha, alpha)',
      replace: 'vec4f(color.rgb * bitcast<f32>(0x7fc00000u | (u32(alpha) & 1u)), alpha)',
    },
    tiles: {
      file: 'lib/tile-blend',
      find: 'vec4f(pixel.color, 1.0 - pixel.transmittance)',
      replace:
        'vec4f(pixel.color * bitcast<f32>(0x7fc00000u | (u32(pixel.color.r) & 1u)), 1.0 - pixel.transmittance)',
    },
  })) {
    gpuTest(`fails if the image of ${rasterizer}, and no other, is not finite`, async () => {
      const found = await failuresOf(SOUND, { mutation: infinite });
      const place = 'column \\d+, row \\d+, channel 0';
      expect(found).toMatch(
        new RegExp(
          `^sound, camera front, reference, ${rasterizer}: ${place}: got NaN, which is not finite$`,
          'm',
        ),
      );
      for (const other of CASE_RASTERIZERS)
        if (other !== rasterizer) expect(found).not.toContain(`, ${other}: `);
    });
  }

  gpuTest('fails if a stage is wrong, even if the image hardly shows it', async () => {
    const mutation = {
      file: 'stages/project',
      find: 'record.minorLengthPx = axes.minorLengthPx;',
      replace: 'record.minorLengthPx = axes.minorLengthPx * 1.0003;',
    };
    const { failures, images } = await runner.run(SOUND, { mutation });
    for (const rasterizer of CASE_RASTERIZERS)
      expect(images[rasterizer].reference?.psnrDb).toBeGreaterThan(55);
    expect(failures.join('\n')).toMatch(
      /sound, camera front, reference: cloud 0, splat \d+, minorLengthPx: got /,
    );
  });

  gpuTest('fails if shaders do not compile or a case throws, and goes on', async () => {
    const mutation = { file: 'stages/project', find: 'keys[index] =', replace: 'keys[index] = 1.5 *' };
    expect(await failuresOf(SOUND, { mutation })).toMatch(/error/i);
    const throws = () => {
      throw new RangeError('no splats today');
    };
    expect(await failuresOf({ ...SOUND, clouds: throws })).toBe('sound: RangeError: no splats today');
    expect((await runner.run(SOUND)).failures).toEqual([]);
  });

  gpuTest('reports a lost device and makes another', async () => {
    const devices: GPUDevice[] = [];
    const watching = {
      async requestAdapter() {
        const { adapter } = await createNodeGpu();
        const requestDevice = adapter.requestDevice.bind(adapter);
        adapter.requestDevice = async (descriptor) => {
          devices.push(await requestDevice(descriptor));
          return devices[devices.length - 1];
        };
        return adapter;
      },
    };
    const own = await HardCaseRunner.create({ gpu: watching });
    const losing = () => {
      devices[0].destroy();
      return SOUND.clouds();
    };
    expect(await failuresOf({ ...SOUND, clouds: losing }, {}, own)).toContain(
      'the device was lost (destroyed)',
    );
    expect((await own.run(SOUND)).failures).toEqual([]);
    expect(devices).toHaveLength(2);
    own.destroy();
  });

  gpuTest('fails if a file is not refused, an order is wrong or arithmetic is wrong', async () => {
    const base = { name: 'doctored', group: 'input', breaks: 'Nothing.' } as const;
    const file = () => encodePly(splatsOf(ordinarySplats()));
    expect(await failuresOf({ ...base, kind: 'refused-file', file, code: 'truncated' })).toMatch(
      /got \d+ splats/,
    );
    const short = () => file().slice(0, -5);
    expect(await failuresOf({ ...base, kind: 'refused-file', file: short, code: 'empty' })).toContain(
      'expected SplatFileError empty',
    );
    const keys = () => Uint32Array.of(7, 70_000);
    expect((await runner.run({ ...base, kind: 'sort', keys, keyBits: 24 })).failures).toEqual([]);
    const tooWide = () => Uint32Array.of(70_000, 7 + 2 ** 20);
    expect(await failuresOf({ ...base, kind: 'sort', keys: tooWide, keyBits: 16 })).toMatch(/order: place 0/);
    expect(await failuresOf({ ...base, kind: 'arithmetic', check: () => '1 is 2' })).toBe('doctored: 1 is 2');
  });

  gpuTest('fails if a first camera is not the expected one, is not a good one, or is not found', async () => {
    const [found] = HARD_CASES.filter((hardCase) => hardCase.kind === 'framing');
    expect((await runner.run(found)).failures).toEqual([]);
    const { position } = found.cameras.packed;
    const moved = {
      ...found.cameras.packed,
      position: [position[0] + 1e-9, position[1], position[2]],
    } as const;
    const cameras = { ...found.cameras, packed: moved };
    const { failures } = await runner.run({ ...found, cameras });
    expect(failures).toHaveLength(1);
    expect(failures[0]).toMatch(
      new RegExp(`^${found.name}, balanced: got .*\\b${position[0]},.*, expected `),
    );
    const expects = [{ what: 'it is elsewhere', holds: () => false }];
    expect(await failuresOf({ ...found, expects })).toBe(
      COMPARED_PRESETS.map((preset) => `${found.name}, ${preset}: expected that it is elsewhere`).join('\n'),
    );
    const transparent = splatsOf([{ opacityLogit: Number.NEGATIVE_INFINITY }]);
    expect(await failuresOf({ ...found, clouds: () => [{ set: transparent }] })).toContain('found no camera');
  });

  gpuTest('runs on a device with fewer features, and a hundred frames on two devices', async () => {
    const device = await runner.run({ ...SOUND, kind: 'device', without: ['float32-blendable'] });
    expect(device.failures).toEqual([]);
    for (const rasterizer of CASE_RASTERIZERS)
      expect(device.images[rasterizer].reference?.psnrDb).toBeLessThan(100);
    expect((await runner.run({ ...SOUND, identicalFrames: 100 })).failures).toEqual([]);
  });
});
