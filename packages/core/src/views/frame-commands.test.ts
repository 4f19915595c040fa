import { expect, test } from 'vitest';
import type { Dispatch, DispatchSize, FramePass } from '../gpu/passes.ts';
import { type CommandPart, commandsOf, recordCommand } from './frame-commands.ts';

const QUERIES = {} as GPUQuerySet;
const STAMPS = { querySet: QUERIES, beginningOfPassWriteIndex: 4, endOfPassWriteIndex: 5 };
const [BUFFER, GROUP, VIEW] = [{} as GPUBuffer, {} as GPUBindGroup, {} as GPUTextureView];
const INDIRECT = { buffer: BUFFER, offset: 12 };

function dispatchOf(label: string, size: DispatchSize): Dispatch {
  return { pipeline: { label } as GPUComputePipeline, group: GROUP, size };
}

/** An encoder that lists its commands. */
function listingEncoder() {
  const calls: unknown[][] = [];
  const pass = (descriptor: object) => {
    const call =
      (name: string) =>
      (...args: unknown[]) =>
        void calls.push([name, ...args]);
    calls.push(['begin', descriptor]);
    return {
      setPipeline: ({ label }: GPUObjectBase) => calls.push(['pipeline', label]),
      setBindGroup: () => {},
      dispatchWorkgroups: call('dispatch'),
      dispatchWorkgroupsIndirect: call('dispatch indirect'),
      draw: call('draw'),
      drawIndirect: call('draw indirect'),
      end: () => {},
    };
  };
  const encoder = { beginComputePass: pass, beginRenderPass: pass } as unknown as GPUCommandEncoder;
  return { encoder, calls };
}

function encoded(pass: FramePass, part?: CommandPart): unknown[][][] {
  return commandsOf([pass]).map((command) => {
    const { encoder, calls } = listingEncoder();
    recordCommand(encoder, { writes: () => STAMPS }, command, part, 50);
    return calls;
  });
}

test('each dispatch of a pass becomes a pass, and the first and last have its timestamps', () => {
  const dispatches = [
    dispatchOf('sort-scan sortScan', [1, 1, 1]),
    dispatchOf('sort-scatter sortScatter', [50, 3, 1]),
    dispatchOf('sort-scatter sortScatter', INDIRECT),
  ];
  const pass = { label: 'sort', timed: 'sort', dispatches } as const;
  const [begin, end] = [{ beginningOfPassWriteIndex: 4 }, { endOfPassWriteIndex: 5 }];
  expect(encoded(pass)).toEqual([
    [
      ['begin', { label: 'sort', timestampWrites: { querySet: QUERIES, ...begin } }],
      ['pipeline', 'sort-scan sortScan'],
      ['dispatch', 1, 1, 1],
    ],
    [
      ['begin', { label: 'sort', timestampWrites: undefined }],
      ['pipeline', 'sort-scatter sortScatter'],
      ['dispatch', 50, 3, 1],
    ],
    [
      ['begin', { label: 'sort', timestampWrites: { querySet: QUERIES, ...end } }],
      ['pipeline', 'sort-scatter sortScatter'],
      ['dispatch indirect', BUFFER, 12],
    ],
  ]);
  expect(commandsOf([pass])).toMatchObject([
    { stage: 'sort-scan', slowestMs: 1, isGuess: false },
    { stage: 'sort-scatter', slowestMs: 150, isGuess: false },
    { stage: 'sort-scatter', isGuess: true },
  ]);
});

test('a part of a dispatch has as many workgroups, in rows', () => {
  const dispatches = [dispatchOf('tile-rasterize tileRasterize', [50, 40, 1])];
  const pass = { label: 'tiles', timed: 'tiles', dispatches } as const;
  const [[begin, , dispatch]] = encoded(pass, { first: 7, count: 120, isLast: true });
  expect(begin[1]).toMatchObject({ timestampWrites: { querySet: QUERIES, endOfPassWriteIndex: 5 } });
  expect(dispatch).toEqual(['dispatch', 50, 3, 1]);
});

test('only the first part of a drawing clears, and parts draw ranges of what is drawn', () => {
  const attachment = { view: VIEW, loadOp: 'clear', storeOp: 'store' } as const;
  const pass: FramePass = {
    label: 'rasterize',
    timed: 'rasterize',
    targets: { colorAttachments: [attachment] },
    pipeline: { label: 'rasterize' } as GPURenderPipeline,
    group: GROUP,
    draws: [{ buffer: BUFFER, offset: 0 }],
  };
  const loadsOf = (calls: unknown[][]) =>
    (calls[0][1] as GPURenderPassDescriptor).colorAttachments as GPURenderPassColorAttachment[];
  const [whole] = encoded(pass);
  expect(loadsOf(whole)[0].loadOp).toBe('clear');
  expect(whole[2]).toEqual(['draw indirect', BUFFER, 0]);
  const [first] = encoded(pass, { first: 0, count: 10, isLast: false });
  expect(loadsOf(first)[0].loadOp).toBe('clear');
  expect(first[2]).toEqual(['draw', 4, 10, 0, 0]);
  const [second] = encoded(pass, { first: 10, count: 5, isLast: true });
  expect(loadsOf(second)[0].loadOp).toBe('load');
  expect(second[2]).toEqual(['draw', 4, 5, 0, 10]);
  const [none] = encoded(pass, { first: 0, count: 0, isLast: true });
  expect(none).toHaveLength(2);
});
