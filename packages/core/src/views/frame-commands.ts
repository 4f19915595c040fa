import { stageNameOf } from '../gpu/pipelines.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import type { Work } from './submission-pacer.ts';

/** A part of a command that can be divided. */
export interface CommandPart {
  readonly first: number;
  readonly count: number;
  /** Whether it is the last part. */
  readonly isLast: boolean;
}

/** A dispatch, or a pass that draws. */
export interface FrameCommand extends Work {
  /** Encodes the whole, or a part: of the tiles of `tile-rasterize`, or of the quads of `rasterize`. */
  readonly encode: (encoder: GPUCommandEncoder, part?: CommandPart) => void;
}

type Stamps = GPUComputePassTimestampWrites & GPURenderPassTimestampWrites;

/** What a workgroup takes on the slowest devices. */
const SLOWEST_WORKGROUP_MS = 1;
/** Workgroups of a dispatch whose number only the GPU knows: there are no fewer, or it would be dispatched directly. */
const INDIRECT_WORKGROUPS = 65_536;

/**
 * Records a frame as a list of commands that can be submitted one by one, each in a pass of its own. Parts of a frame know
 * nothing of it; what they call is there, and anything else fails at once.
 *
 * @param dispatchRow most workgroups in one dimension of a dispatch.
 */
export function commandsOf(
  record: (encoder: GPUCommandEncoder) => void,
  dispatchRow: number,
): readonly FrameCommand[] {
  const commands: FrameCommand[] = [];
  record({
    beginComputePass: (descriptor: GPUComputePassDescriptor) =>
      computePass(commands, descriptor, dispatchRow),
    beginRenderPass: (descriptor: GPURenderPassDescriptor) => renderPass(commands, descriptor),
  } as unknown as GPUCommandEncoder);
  return commands;
}

function computePass(
  commands: FrameCommand[],
  { label, timestampWrites }: GPUComputePassDescriptor,
  dispatchRow: number,
): GPUComputePassEncoder {
  let pipeline: GPUComputePipeline;
  let group: GPUBindGroup | null | undefined;
  const dispatches: FrameCommand[] = [];
  const add = (workgroups: number, dispatch: (pass: GPUComputePassEncoder, part?: CommandPart) => void) => {
    const [used, bound, index] = [pipeline, group, dispatches.length];
    dispatches.push({
      stage: stageNameOf(used),
      slowestMs: SLOWEST_WORKGROUP_MS * workgroups,
      encode: (encoder, part) => {
        const begins = index === 0 && (part?.first ?? 0) === 0;
        const ends = index === dispatches.length - 1 && (part?.isLast ?? true);
        const stamps = stampsOf(timestampWrites, begins, ends);
        const pass = encoder.beginComputePass({ label, timestampWrites: stamps });
        pass.setPipeline(used);
        pass.setBindGroup(0, bound);
        dispatch(pass, part);
        pass.end();
      },
    });
  };
  return {
    setPipeline: (next: GPUComputePipeline) => {
      pipeline = next;
    },
    setBindGroup: (_: number, next: GPUBindGroup | null | undefined) => {
      group = next;
    },
    dispatchWorkgroups: (x: number, y = 1, z = 1) =>
      add(x * y * z, (target, part) =>
        target.dispatchWorkgroups(...(part ? dispatchSize(part.count, dispatchRow) : ([x, y, z] as const))),
      ),
    dispatchWorkgroupsIndirect: (...where: [GPUBuffer, number]) =>
      add(INDIRECT_WORKGROUPS, (target) => target.dispatchWorkgroupsIndirect(...where)),
    end: () => commands.push(...dispatches),
  } as unknown as GPUComputePassEncoder;
}

/** Render passes draw once. */
function renderPass(commands: FrameCommand[], descriptor: GPURenderPassDescriptor): GPURenderPassEncoder {
  let pipeline: GPURenderPipeline;
  let group: GPUBindGroup | null | undefined;
  const add = (draw: (pass: GPURenderPassEncoder, part?: CommandPart) => void) => {
    const [used, bound] = [pipeline, group];
    commands.push({
      stage: stageNameOf(used),
      slowestMs: 0,
      encode: (encoder, part) => {
        const isFirst = (part?.first ?? 0) === 0;
        const attachments = [...descriptor.colorAttachments];
        const pass = encoder.beginRenderPass({
          ...descriptor,
          colorAttachments: isFirst ? attachments : attachments.map((each) => each && kept(each)),
          timestampWrites: stampsOf(descriptor.timestampWrites, isFirst, part?.isLast ?? true),
        });
        pass.setPipeline(used);
        pass.setBindGroup(0, bound);
        draw(pass, part);
        pass.end();
      },
    });
  };
  return {
    setPipeline: (next: GPURenderPipeline) => {
      pipeline = next;
    },
    setBindGroup: (_: number, next: GPUBindGroup | null | undefined) => {
      group = next;
    },
    draw: (vertices: number) => add((target) => target.draw(vertices)),
    drawIndirect: (...where: [GPUBuffer, number]) =>
      add((target, part) => {
        if (!part) target.drawIndirect(...where);
        // Dawn warns of draws of nothing; the pass alone may clear its target.
        else if (part.count > 0) target.draw(4, part.count, 0, part.first);
      }),
    end: () => {},
  } as unknown as GPURenderPassEncoder;
}

function kept(attachment: GPURenderPassColorAttachment): GPURenderPassColorAttachment {
  return { ...attachment, loadOp: 'load' };
}

/** The timestamps of a whole pass that its first and its last part write. */
function stampsOf(whole: Stamps | undefined, begins: boolean, ends: boolean): Stamps | undefined {
  if (!whole || !(begins || ends)) return undefined;
  const { querySet, beginningOfPassWriteIndex, endOfPassWriteIndex } = whole;
  return {
    querySet,
    ...(begins && { beginningOfPassWriteIndex }),
    ...(ends && { endOfPassWriteIndex }),
  };
}
