import { WebSplatterError } from '../data/errors.ts';
import { numberOf } from '../data/number-of.ts';
import { frameStages } from '../frame/frame-passes.ts';
import { FramePlanner } from '../frame/plan/frame-planner.ts';
import type { FrameOutput } from '../frame/plan/frame-shape.ts';
import type { StageDefinition } from '../gpu/pipelines.ts';
import { loadVariant } from '../gpu/shaders/link-shader.ts';
import type { RasterizeDepth } from '../stages/quads/quads.ts';
import { sortDeviceOf } from '../stages/sort/sort.ts';
import { type FrameMember, frameMembers, MemberFrames } from './frame-members.ts';
import { seededRandom } from './seeded-random.ts';

const SIZE = { widthPx: 32, heightPx: 32 };
const TRIPLES = 500;
const DEPTH = { mapping: 'projection', compare: 'less-equal', isOrthographic: false } as const;
const IMAGE = { kind: 'image' } as const;
const HOST = { kind: 'host' } as const;

/** Everything that frames are drawn into, with the depth that they test or write. */
const HOSTS: readonly (readonly [FrameOutput, RasterizeDepth | null])[] = [
  [IMAGE, null],
  [{ kind: 'canvas', format: 'bgra8unorm', storable: null }, null],
  [{ kind: 'canvas', format: 'rgba8unorm', storable: 'rgba8unorm' }, null],
  [HOST, null],
  [HOST, { ...DEPTH, isTested: true, layerFormat: null }],
  [HOST, { ...DEPTH, isTested: true, layerFormat: 'r32float' }],
  [HOST, { ...DEPTH, isTested: false, layerFormat: 'r16float' }],
];

/** Stages of frames in which several members of `frameMembers` meet. */
export class StagesTogether {
  readonly #device: GPUDevice;
  readonly #members: readonly FrameMember[];
  readonly #frames: MemberFrames;
  /** Stages that were returned, by all that their texts depend on. */
  readonly #known = new Set<string>();

  constructor(device: GPUDevice) {
    this.#device = device;
    this.#members = frameMembers(device);
    this.#frames = new MemberFrames(device);
  }

  /** All pairs of members, but for pairs that make the cloud in ways of their own. */
  pairs(): readonly (readonly FrameMember[])[] {
    const all = this.#members.flatMap((a, i) => this.#members.slice(i + 1).map((b) => [a, b]));
    return all.filter(canMeet);
  }

  /** Seeded sets of up to three members. */
  triples(): readonly (readonly FrameMember[])[] {
    const random = seededRandom(TRIPLES);
    const anyOf = () => this.#members[Math.floor(this.#members.length * random())];
    const all = Array.from({ length: TRIPLES }, () => {
      const some = [anyOf(), anyOf(), anyOf()];
      return this.#members.filter((member) => some.includes(member));
    });
    return all.filter(canMeet);
  }

  /**
   * Returns the stages of a frame of `some` for every host that no call before has returned, with all of
   * their texts. Null if the members refuse each other by a typed error.
   */
  async newStagesOf(some: readonly FrameMember[]): Promise<StageDefinition[] | null> {
    try {
      return await this.#newStagesOf(some);
    } catch (error) {
      if (error instanceof WebSplatterError) return null;
      throw new Error(some.map(({ name }) => name).join(' + '), { cause: error });
    }
  }

  async #newStagesOf(some: readonly FrameMember[]): Promise<StageDefinition[]> {
    const { request } = await this.#frames.frameOf(some);
    for (const { cloud } of request.clouds) await cloud.uploaded;
    const { accuracy } = await this.#frames.engineFor(some);
    const { maxComputeWorkgroupsPerDimension: dispatchRow } = this.#device.limits;
    const context = { dispatchRow, sortDevice: sortDeviceOf(this.#device) };
    const found: StageDefinition[] = [];
    for (const [output, depth] of HOSTS) {
      const planner = new FramePlanner(context, output, () => true);
      const plan = planner.plan({ ...request, ...SIZE }, { accuracy, depth, faster: 'tiles' });
      for (const entry of frameStages(plan.shape)) {
        const stage = 'stage' in entry ? entry : entry[0];
        const { conditions, constants, effects } = stage;
        const key = JSON.stringify([stage.stage, conditions, constants, effects && numberOf(effects)]);
        if (this.#known.has(key)) continue;
        this.#known.add(key);
        found.push(await loadVariant(stage));
      }
    }
    return found;
  }

  destroy(): Promise<void> {
    return this.#frames.destroy();
  }
}

function canMeet(some: readonly FrameMember[]): boolean {
  return some.filter(({ load }) => load).length < 2;
}
