import { perspectiveCamera, type SplatSet } from '@websplatter/core';
import { expect, it } from 'vitest';
import { fakeTools } from './inspect-tools.fixture.ts';
import { SplatInspector } from './splat-inspector.ts';

const set: SplatSet = {
  count: 1,
  origin: [0, 0, 0],
  positions: Float32Array.of(0, 0, 0),
  logScales: new Float32Array(3),
  rotations: Float32Array.of(1, 0, 0, 0),
  opacityLogits: Float32Array.of(2),
  colorDc: new Float32Array(3),
  harmonics: { degree: 0, coefficients: new Float32Array() },
  fileIndices: Uint32Array.of(7),
  dropped: {},
};
const pick = { cloudIndex: 0, row: 7, alpha: 0.5, weight: 0.25, totalOpacity: 0.9, rank: 12 };
const camera = perspectiveCamera({ position: [0, 0, 5], target: [0, 0, 0], aspect: 1, fovYDegrees: 50 });
const frame = { camera, clouds: [{}], widthPx: 100, heightPx: 100 };

it('tells a picked splat’s share, then its values, then how it is seen', async () => {
  const { tools, viewer, ask, inspecting } = fakeTools(pick);
  Object.assign(viewer, { shownFrame: { frame } });
  let tell = (_: unknown) => {};
  ask.mockImplementation(() => new Promise((resolve) => (tell = resolve)));
  const picking = new SplatInspector(tools).pickAt(0.5, 0.5);
  await expect.poll(() => inspecting().splat).toMatchObject({ row: 7, set: null, seen: null });
  expect(inspecting().splat?.share).toMatchObject({ alpha: 0.5, weight: 0.25, rank: 12, visible: null });
  tell(set);
  await picking;
  expect(ask.mock.lastCall).toEqual(['splat', { cloudIndex: 0, row: 7 }]);
  expect(inspecting().splat).toMatchObject({ set, seen: { depthView: 5, colors: [[0.5, 0.5, 0.5]] } });
});

it('only the splat that was asked for last is shown', async () => {
  const { tools, ask, inspecting } = fakeTools(pick);
  const inspector = new SplatInspector(tools);
  const tells: ((answer: unknown) => void)[] = [];
  ask.mockImplementation(() => new Promise((resolve) => tells.push(resolve)));
  const asked = [inspector.showRow(1), inspector.showRow(2)];
  tells[0]({ ...set, count: 99 });
  await asked[0];
  expect(inspecting().splat).toMatchObject({ row: 2, set: null, share: null });
  tells[1](set);
  await asked[1];
  expect(inspecting().splat?.set).toBe(set);
});

it('says where nothing is, in the image and in the file', async () => {
  const nowhere = fakeTools(null);
  await new SplatInspector(nowhere.tools).pickAt(0, 0);
  expect(nowhere.inspecting()).toMatchObject({ splat: null, problem: 'No splat is drawn there.' });
  const { tools, ask, inspecting } = fakeTools();
  ask.mockResolvedValue(null);
  await new SplatInspector(tools).showRow(123);
  expect(inspecting()).toMatchObject({ splat: null, problem: expect.stringContaining('123') });
});

it('goes on with what was not read when the panel was closed', async () => {
  const { tools, ask, inspecting } = fakeTools(pick);
  const inspector = new SplatInspector(tools);
  ask.mockResolvedValueOnce(undefined);
  await inspector.showRow(7);
  expect(inspecting().splat?.set).toBeNull();
  ask.mockResolvedValueOnce(set);
  inspector.resume();
  await expect.poll(() => inspecting().splat?.set).toBe(set);
});
