import { beforeEach, expect, test, vi } from 'vitest';

const device = {
  destroy: vi.fn(),
  createBuffer: vi.fn(),
  adapterInfo: {},
  limits: {},
} as unknown as GPUDevice;

beforeEach(() => {
  vi.resetModules();
  vi.unstubAllGlobals();
  vi.mocked(device.destroy).mockClear();
});

/** The module under test, with an engine whose code arrives or does not. */
async function loaded(code: () => object) {
  const askedFor = vi.fn(code);
  const tilesAskedFor = vi.fn(() => ({ files: {} }));
  vi.doMock('./engine.ts', askedFor);
  vi.doMock('./stages/tiles/tiles.texts.ts', tilesAskedFor);
  const errors = await import('./data/errors.ts');
  return { ...(await import('./create-engine.ts')), ...errors, askedFor, tilesAskedFor };
}

const CODE = () => ({
  SplatEngine: class {
    readonly given: unknown[];

    constructor(...given: unknown[]) {
      this.given = given;
    }
  },
});

const OFFLINE = () => {
  throw new TypeError('offline');
};

function adapterOf(requestDevice: () => Promise<GPUDevice> = async () => device): GPUAdapter {
  return { features: new Set(), limits: {}, requestDevice } as unknown as GPUAdapter;
}

test('the code of an engine is fetched while a device is asked for', async () => {
  const { SplatEngine, askedFor, tilesAskedFor } = await loaded(CODE);
  const adapter = adapterOf(async () => {
    // Were it asked for afterwards, there never would be a device.
    await expect.poll(() => askedFor).toHaveBeenCalledTimes(1);
    await expect.poll(() => tilesAskedFor).toHaveBeenCalledTimes(1);
    return device;
  });
  expect(await SplatEngine.create({ adapter })).toMatchObject({ given: [device, true, { adapter }, {}] });
  const own = await SplatEngine.create({ device });
  expect(own).toMatchObject({ given: [device, false, { device }, {}] });
});

test('bad options are refused before anything is asked for', async () => {
  const { SplatEngine, InvalidArgumentError, askedFor } = await loaded(CODE);
  const requestDevice = vi.fn<() => Promise<GPUDevice>>();
  const options = { adapter: adapterOf(requestDevice), memoryBudgetBytes: -1 };
  await expect(SplatEngine.create(options)).rejects.toThrow(InvalidArgumentError);
  expect(requestDevice).not.toHaveBeenCalled();
  expect(askedFor).not.toHaveBeenCalled();
});

/**
 * @fault Devices and engines: a device of WebGPU's compatibility mode, whose vertex shaders read no storage buffers
 * @consequence `WebGpuUnavailableError` from `SplatEngine.create`, which names the limit; a device of its own is freed
 */
test.each([
  [0, /InVertexStage is 0, splats need 2/],
  [1, /InVertexStage is 1, splats need 2/],
])('a device whose vertex shaders read %i storage buffers is refused', async (most, message) => {
  const { SplatEngine, WebGpuUnavailableError } = await loaded(CODE);
  const limited = (maxStorageBuffersInVertexStage: number) =>
    ({ ...device, limits: { maxStorageBuffersInVertexStage } }) as unknown as GPUDevice;
  const failure = await SplatEngine.create({ device: limited(most) }).catch((error) => error);
  expect(failure).toBeInstanceOf(WebGpuUnavailableError);
  expect(failure.message).toMatch(/compatibility mode/);
  expect(failure.message).toMatch(message);
  expect(device.destroy, 'of the caller').not.toHaveBeenCalled();
  const adapter = adapterOf(async () => limited(most));
  await expect(SplatEngine.create({ adapter })).rejects.toThrow(message);
  expect(device.destroy).toHaveBeenCalledTimes(1);
  await SplatEngine.create({ device: limited(2) });
});

/**
 * @fault Devices and engines: the code of the engine cannot be fetched
 * @consequence `CodeUnavailableError`; the new device is freed
 */
test('code that cannot be fetched is an error that says so, and the device that was made for it ends', async () => {
  const { SplatEngine, CodeUnavailableError } = await loaded(OFFLINE);
  const failure = await SplatEngine.create({ adapter: adapterOf() }).catch((error) => error);
  expect(failure).toBeInstanceOf(CodeUnavailableError);
  expect(failure).toMatchObject({ name: 'CodeUnavailableError', code: 'code-unavailable' });
  expect(failure.message).toMatch(
    /^The code of the engine could not be fetched \(.*\)\. Check the connection/s,
  );
  expect(device.destroy).toHaveBeenCalledTimes(1);
  await expect(SplatEngine.create({ device })).rejects.toThrow(CodeUnavailableError);
  expect(device.destroy, 'of the caller').toHaveBeenCalledTimes(1);
});

test('a page without a device and without code is told of the device', async () => {
  const { SplatEngine, WebGpuUnavailableError } = await loaded(OFFLINE);
  const adapter = adapterOf(() => Promise.reject(new Error('none')));
  await expect(SplatEngine.create({ adapter })).rejects.toThrow(WebGpuUnavailableError);
});

test('code is foreseen where there is WebGPU, and nowhere else; its failure is told by create', async () => {
  const { foreseeEngine, tilesAskedFor, askedFor } = await loaded(OFFLINE);
  vi.stubGlobal('navigator', {});
  foreseeEngine();
  expect(tilesAskedFor).not.toHaveBeenCalled();
  vi.stubGlobal('navigator', { gpu: {} });
  foreseeEngine();
  await expect.poll(() => tilesAskedFor).toHaveBeenCalledTimes(1);
  await expect.poll(() => askedFor).toHaveBeenCalledTimes(1);
});
