import { collectGarbage } from '@websplatter/node/collect-garbage';
import { beforeAll, describe, expect, test, vi } from 'vitest';
import { zeroCounters } from './engine-counters.ts';
import { MAX_KEPT_PIPELINES, Pipelines, type StageDefinition } from './pipelines.ts';

beforeAll(() => {
  vi.stubGlobal('GPUShaderStage', { VERTEX: 1, FRAGMENT: 2, COMPUTE: 4 });
});

/** A device whose pipelines and shader modules are empty objects, and references to these. */
function fakeDevice() {
  const made: WeakRef<object>[] = [];
  const make = () => {
    const thing = {};
    made.push(new WeakRef(thing));
    return thing;
  };
  let lose = () => {};
  const device = {
    lost: new Promise<void>((resolve) => {
      lose = resolve;
    }),
    createBindGroupLayout: () => ({}),
    createPipelineLayout: () => ({}),
    createShaderModule: make,
    createComputePipelineAsync: async () => make(),
    pushErrorScope: () => {},
    popErrorScope: async () => null,
  } as unknown as GPUDevice;
  return { device, lose, alive: () => made.filter((each) => each.deref() !== undefined).length };
}

/** Stages that differ in a setting, which their shaders use. */
function variants(count: number): StageDefinition[] {
  const text =
    'import constants::SETTING;\n@compute @workgroup_size(1)\nfn main() { let setting = SETTING; }';
  const texts = { modules: { 'package::stages::variant': text } };
  return Array.from({ length: count }, (_, SETTING) => ({
    stage: 'variant',
    texts,
    entryPoint: 'main',
    constants: { SETTING },
  }));
}

describe('Pipelines', () => {
  /**
   * @fault GPU memory: ever more settings and effects are tried
   * @consequence 256 unused pipelines are kept
   */
  test('of ever more settings leave memory, but for those that were used last', async () => {
    const { device, alive } = fakeDevice();
    const counting = zeroCounters();
    const pipelines = new Pipelines(device, undefined, counting);
    const count = 3 * MAX_KEPT_PIPELINES;
    for (const stage of variants(count)) await pipelines.prepare([stage]);
    expect(counting.pipelinesCompiled).toBe(count);
    await collectGarbage();
    // As many modules as pipelines.
    expect(alive()).toBe(2 * MAX_KEPT_PIPELINES);
  });

  /**
   * @fault Devices and engines: the page keeps a lost device
   * @consequence its shaders are freed
   */
  test('leave memory when their device is lost, though that is held', async () => {
    const { device, lose, alive } = fakeDevice();
    await new Pipelines(device).prepare(variants(3));
    await collectGarbage();
    // Another engine on the device would find them.
    expect(alive()).toBe(6);
    lose();
    await collectGarbage();
    expect(alive()).toBe(0);
    expect(device.lost).toBeDefined();
  });

  test('stay for as long as their stage is held, in any number', async () => {
    const { device } = fakeDevice();
    const counting = zeroCounters();
    const pipelines = new Pipelines(device, undefined, counting);
    const stages = variants(MAX_KEPT_PIPELINES + 50);
    await pipelines.prepare(stages);
    expect(pipelines.areReady(stages)).toBe(true);
    const first = pipelines.compute(stages[0]);
    await pipelines.prepare(stages);
    expect(counting.pipelinesCompiled).toBe(stages.length);
    expect(pipelines.compute(stages[0])).toBe(first);
  });

  test('are compiled again for an equal stage whose last use is long ago, and only for that', async () => {
    const { device } = fakeDevice();
    const counting = zeroCounters();
    const pipelines = new Pipelines(device, undefined, counting);
    const count = MAX_KEPT_PIPELINES + 1;
    await pipelines.prepare(variants(count));
    const [oldest, ...recent] = variants(count);
    expect(pipelines.areReady(recent)).toBe(true);
    await pipelines.prepare(recent);
    expect(counting.pipelinesCompiled).toBe(count);
    expect(pipelines.compute(oldest)).toBeUndefined();
    await pipelines.prepare([oldest]);
    expect(counting.pipelinesCompiled).toBe(count + 1);
  });
});
