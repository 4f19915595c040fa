import { stageNameOf } from '../gpu/pipelines.ts';
import type { Work } from '../gpu/timing/submission-pacer.ts';
import { dispatchSize } from '../stages/dispatch.ts';

/** A range of a divisible command. */
export interface CommandPart {
  readonly first: number;
  readonly count: number;
  /** Whether it is the last part. */
  readonly isLast: boolean;
}

/** A dispatch, or a pass that draws. */
export interface FrameCommand extends Work {
  /** Encodes all of the command, or a range: tiles of `tile-rasterize`, or quads of `rasterize`. */
  readonly encode: (encoder: GPUCommandEncoder, part?: CommandPart) => void;
}

type Stamps = GPUComputePassTimestampWrites & GPURenderPassTimestampWrites;

/** Time of a workgroup on the slowest devices, ms. */
const SLOWEST_WORKGROUP_MS = 1;
/** Assumed for indirect dispatches, whose number of workgroups only the GPU knows. */
const GUESSED_WORKGROUPS = 65_536;

/**
 * Records a frame as a list of commands that can be submitted one by one, each in a pass of its
 * own. `record` gets a stand-in for an encoder with the methods that parts of a frame call; calls
 * of any other method throw.
 *
 * @param dispatchRow most workgroups in one dimension of a dispatch.
 */
export function commandsOf(
  record: (encoder: GPUCommandEncoder) => void,
  dispatchRow: number,
): readonly FrameCommand[] {
  const commands: FrameCommand[] = [];
  record({
    beginComputePass: ({ label, timestampWrites }: GPUComputePassDescriptor) =>
      recordedPass(commands, dispatchRow, (encoder, begins, ends) =>
        encoder.beginComputePass({ label, timestampWrites: stampsOf(timestampWrites, begins, ends) }),
      ),
    beginRenderPass: (descriptor: GPURenderPassDescriptor) =>
      recordedPass(commands, dispatchRow, (encoder, begins, ends) => {
        const attachments = [...descriptor.colorAttachments];
        return encoder.beginRenderPass({
          ...descriptor,
          colorAttachments: begins ? attachments : attachments.map((each) => each && kept(each)),
          timestampWrites: stampsOf(descriptor.timestampWrites, begins, ends),
        });
      }),
  } as unknown as GPUCommandEncoder);
  return commands;
}

/**
 * The methods of compute and render passes that parts of a frame call. Each render pass draws once.
 */
type Pass = Pick<GPUComputePassEncoder, 'dispatchWorkgroups' | 'dispatchWorkgroupsIndirect'> &
  Pick<GPURenderPassEncoder, 'setPipeline' | 'setBindGroup' | 'draw' | 'drawIndirect' | 'end'>;

/**
 * Returns a pass whose dispatches or draws become commands when it ends.
 *
 * @param begin begins the pass of one command. `begins` and `ends` are true for the first and the
 *   last command of the whole pass.
 */
function recordedPass(
  commands: FrameCommand[],
  dispatchRow: number,
  begin: (encoder: GPUCommandEncoder, begins: boolean, ends: boolean) => unknown,
): Pass {
  let pipeline: GPURenderPipeline;
  let group: GPUBindGroup | null | undefined;
  const own: FrameCommand[] = [];
  const add = (workgroups: number | null, run: (pass: Pass, part?: CommandPart) => void) => {
    const [used, bound, index] = [pipeline, group, own.length];
    own.push({
      stage: stageNameOf(used),
      slowestMs: SLOWEST_WORKGROUP_MS * (workgroups ?? GUESSED_WORKGROUPS),
      isGuess: workgroups === null,
      encode: (encoder, part) => {
        const begins = index === 0 && (part?.first ?? 0) === 0;
        const ends = index === own.length - 1 && (part?.isLast ?? true);
        const pass = begin(encoder, begins, ends) as Pass;
        pass.setPipeline(used);
        pass.setBindGroup(0, bound);
        run(pass, part);
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
    dispatchWorkgroups: (x: number, y = 1, z = 1) =>
      add(x * y * z, (pass, part) =>
        pass.dispatchWorkgroups(...(part ? dispatchSize(part.count, dispatchRow) : ([x, y, z] as const))),
      ),
    dispatchWorkgroupsIndirect: (...where: [GPUBuffer, number]) =>
      add(null, (pass) => pass.dispatchWorkgroupsIndirect(...where)),
    draw: (vertices: number) => add(0, (pass) => pass.draw(vertices)),
    drawIndirect: (...where: [GPUBuffer, number]) =>
      add(0, (pass, part) => {
        if (!part) pass.drawIndirect(...where);
        // Dawn warns about empty draws; the pass is still needed if it clears its target.
        else if (part.count > 0) pass.draw(4, part.count, 0, part.first);
      }),
    end: () => commands.push(...own),
  } as unknown as Pass;
}

function kept(attachment: GPURenderPassColorAttachment): GPURenderPassColorAttachment {
  return { ...attachment, loadOp: 'load' };
}

/** The timestamps of the whole pass: its first command writes the beginning, its last the end. */
function stampsOf(whole: Stamps | undefined, begins: boolean, ends: boolean): Stamps | undefined {
  if (!whole || !(begins || ends)) return undefined;
  const { querySet, beginningOfPassWriteIndex, endOfPassWriteIndex } = whole;
  return {
    querySet,
    ...(begins && { beginningOfPassWriteIndex }),
    ...(ends && { endOfPassWriteIndex }),
  };
}
