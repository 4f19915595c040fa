import { expect, test } from 'vitest';
import { type CommandPart, commandsOf } from './frame-commands.ts';

const QUERIES = {} as GPUQuerySet;
const STAMPS = { querySet: QUERIES, beginningOfPassWriteIndex: 4, endOfPassWriteIndex: 5 };
const [BUFFER, GROUP, VIEW] = [{} as GPUBuffer, {} as GPUBindGroup, {} as GPUTextureView];

function pipelineOf(label: string) {
  return { label } as GPUComputePipeline & GPURenderPipeline;
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

function encoded(record: (encoder: GPUCommandEncoder) => void, part?: CommandPart): unknown[][][] {
  return commandsOf(record, 50).map((command) => {
    const { encoder, calls } = listingEncoder();
    command.encode(encoder, part);
    return calls;
  });
}

test('each dispatch of a pass becomes a pass, and the first and last have its timestamps', () => {
  const record = (encoder: GPUCommandEncoder) => {
    const pass = encoder.beginComputePass({ label: 'sort', timestampWrites: STAMPS });
    pass.setPipeline(pipelineOf('plan-sort planSort'));
    pass.setBindGroup(0, GROUP);
    pass.dispatchWorkgroups(1);
    pass.setPipeline(pipelineOf('sort-scatter sortScatter'));
    pass.dispatchWorkgroups(50, 3);
    pass.dispatchWorkgroupsIndirect(BUFFER, 12);
    pass.end();
  };
  const [begin, end] = [{ beginningOfPassWriteIndex: 4 }, { endOfPassWriteIndex: 5 }];
  expect(encoded(record)).toEqual([
    [
      ['begin', { label: 'sort', timestampWrites: { querySet: QUERIES, ...begin } }],
      ['pipeline', 'plan-sort planSort'],
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
  expect(commandsOf(record, 50).map(({ stage }) => stage)).toEqual([
    'plan-sort',
    'sort-scatter',
    'sort-scatter',
  ]);
});

test('a part of a dispatch has as many workgroups, in rows', () => {
  const record = (encoder: GPUCommandEncoder) => {
    const pass = encoder.beginComputePass({ label: 'tiles', timestampWrites: STAMPS });
    pass.setPipeline(pipelineOf('tile-rasterize tileRasterize'));
    pass.dispatchWorkgroups(50, 40);
    pass.end();
  };
  const [[begin, , dispatch]] = encoded(record, { first: 7, count: 120, isLast: true });
  expect(begin[1]).toMatchObject({ timestampWrites: { querySet: QUERIES, endOfPassWriteIndex: 5 } });
  expect(dispatch).toEqual(['dispatch', 50, 3, 1]);
});

test('only the first part of a drawing clears, and parts draw ranges of what is drawn', () => {
  const record = (encoder: GPUCommandEncoder) => {
    const attachment = { view: VIEW, loadOp: 'clear', storeOp: 'store' } as const;
    const pass = encoder.beginRenderPass({ label: 'rasterize', colorAttachments: [attachment] });
    pass.setPipeline(pipelineOf('rasterize'));
    pass.drawIndirect(BUFFER, 0);
    pass.end();
  };
  const loadsOf = (calls: unknown[][]) =>
    (calls[0][1] as GPURenderPassDescriptor).colorAttachments as GPURenderPassColorAttachment[];
  const [whole] = encoded(record);
  expect(loadsOf(whole)[0].loadOp).toBe('clear');
  expect(whole[2]).toEqual(['draw indirect', BUFFER, 0]);
  const [first] = encoded(record, { first: 0, count: 10, isLast: false });
  expect(loadsOf(first)[0].loadOp).toBe('clear');
  expect(first[2]).toEqual(['draw', 4, 10, 0, 0]);
  const [second] = encoded(record, { first: 10, count: 5, isLast: true });
  expect(loadsOf(second)[0].loadOp).toBe('load');
  expect(second[2]).toEqual(['draw', 4, 5, 0, 10]);
  const [none] = encoded(record, { first: 0, count: 0, isLast: true });
  expect(none).toHaveLength(2);
});
