import { type ComputePass, type FramePass, type RenderPass, recordPass } from '../gpu/passes.ts';
import { stageNameOf } from '../gpu/pipelines.ts';
import type { GpuTimer } from '../gpu/timing/gpu-timer.ts';
import type { Work } from '../gpu/timing/submission-pacer.ts';
import { dispatchSize } from '../stages/dispatch.ts';

/** A range of a divisible command. */
export interface CommandPart {
  readonly first: number;
  readonly count: number;
  /** Whether it is the last part. */
  readonly isLast: boolean;
}

/** One dispatch or draw of a pass, to be submitted in a pass of its own. */
export interface FrameCommand extends Work {
  readonly pass: FramePass;
  /** Index in the pass. */
  readonly index: number;
}

/** Time of a workgroup on the slowest devices, ms. */
const SLOWEST_WORKGROUP_MS = 1;
/** Assumed for indirect dispatches, whose number of workgroups only the GPU knows. */
const GUESSED_WORKGROUPS = 65_536;

/** Lists the dispatches and draws of all passes. */
export function commandsOf(passes: readonly FramePass[]): FrameCommand[] {
  return passes.flatMap((pass): FrameCommand[] => {
    if (!('dispatches' in pass)) {
      const stage = stageNameOf(pass.pipeline);
      return pass.draws.map((_, index) => ({ pass, index, stage, slowestMs: 0 }));
    }
    return pass.dispatches.map(({ pipeline, size }, index) => {
      const isGuess = 'buffer' in size;
      const workgroups = isGuess ? GUESSED_WORKGROUPS : size[0] * size[1] * size[2];
      const slowestMs = SLOWEST_WORKGROUP_MS * workgroups;
      return { pass, index, stage: stageNameOf(pipeline), slowestMs, isGuess };
    });
  });
}

/**
 * Records all of a command, or a range of it: tiles of `tile-rasterize`, or quads of `rasterize`.
 * The first command of a pass writes the timestamp of its beginning, the last that of its end.
 *
 * @param dispatchRow most workgroups in one dimension of a dispatch.
 */
export function recordCommand(
  encoder: GPUCommandEncoder,
  timer: Pick<GpuTimer, 'writes'>,
  { pass, index }: FrameCommand,
  part: CommandPart | undefined,
  dispatchRow: number,
): void {
  const isCompute = 'dispatches' in pass;
  const count = isCompute ? pass.dispatches.length : pass.draws.length;
  const begins = index === 0 && (part?.first ?? 0) === 0;
  const ends = index === count - 1 && (part?.isLast ?? true);
  const own = isCompute ? oneDispatch(pass, index, part, dispatchRow) : oneDraw(pass, index, part, begins);
  const whole = timer.writes(pass.timed);
  recordPass(encoder, own, whole && (begins || ends) ? endsOf(whole, begins, ends) : undefined);
}

function oneDispatch(
  pass: ComputePass,
  index: number,
  part: CommandPart | undefined,
  dispatchRow: number,
): ComputePass {
  const dispatch = pass.dispatches[index];
  const own = part ? { ...dispatch, size: dispatchSize(part.count, dispatchRow) } : dispatch;
  return { ...pass, dispatches: [own] };
}

/** @param begins whether the pass may clear its targets. */
function oneDraw(
  pass: RenderPass,
  index: number,
  part: CommandPart | undefined,
  begins: boolean,
): RenderPass {
  const { colorAttachments, ...others } = pass.targets;
  const loaded = [...colorAttachments].map((each) => each && ({ ...each, loadOp: 'load' } as const));
  const targets = begins ? pass.targets : { ...others, colorAttachments: loaded };
  const draw = part ? ([4, part.count, 0, part.first] as const) : pass.draws[index];
  // Dawn warns about empty draws; the pass is still needed if it clears its target.
  return { ...pass, targets, draws: part?.count === 0 ? [] : [draw] };
}

function endsOf(
  { querySet, beginningOfPassWriteIndex, endOfPassWriteIndex }: GPUComputePassTimestampWrites,
  begins: boolean,
  ends: boolean,
): GPUComputePassTimestampWrites {
  return {
    querySet,
    ...(begins && { beginningOfPassWriteIndex }),
    ...(ends && { endOfPassWriteIndex }),
  };
}
